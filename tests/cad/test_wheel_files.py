"""Files of a sector and of a wheel: one closed solid each, with the names and the volume of the native faces."""

from dataclasses import replace

import pytest

from bladewright import cad
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet
from bladewright.cad.mesh import triangulated
from bladewright.cad.solids import occ_solid
from bladewright.domain.sector import sector
from bladewright.domain.wheel import wheel
from machines import coarse

WEB = ((-8.0, 94.0), (-8.0, 60.0), (97.0, 60.0), (97.0, 118.5))
SAMPLES = 100


ROTOR = replace(coarse.ROTOR, blade_count=2, disc=Disc(outline=Outline(points=WEB, radii=(5.0, 0.0))))


@pytest.mark.parametrize(
    "built",
    [
        pytest.param(lambda: sector(ROTOR.build()), id="sector"),
        pytest.param(
            lambda: wheel(replace(ROTOR, hub_fillet=Fillet(radius=2.0), shroud_ring=Disc(thickness=2.0)).build()),
            marks=pytest.mark.slow,
            id="filleted wheel with a ring",
        ),
    ],
)
def test_the_file_is_one_closed_solid_with_every_face(built, tmp_path):
    body = built()
    trip = cad.write(body, tmp_path / "part.step", samples=SAMPLES)
    assert trip.passed, trip.failures
    found = trip.to_dict()
    assert (found["solids"], found["shells"], found["free_edges"]) == (1, 1, 0)
    assert {face["name"] for face in found["faces"]} == set(body.surfaces)
    assert found["edges"]["max_tolerance_mm"] < 1e-5


def test_triangles_of_one_blade_are_turned_to_all_others_and_not_where_that_leaves_gaps():
    body = wheel(replace(ROTOR, blade_count=3).build())
    made = occ_solid(body)
    whole, copied = triangulated(made, 0.5), triangulated(made, 0.5, body.turned_faces)
    assert sorted(body.turned_faces) == sorted(
        f"blade_0{k}_{name}" for k in (2, 3) for name in ("upper", "lower", "shroud")
    )
    assert copied.open_edges == 0
    assert copied.shells == 1
    assert copied.volume == pytest.approx(whole.volume, rel=1e-4)
    lost = {name: (first, -turn) for name, (first, turn) in body.turned_faces.items()}
    found = triangulated(made, 0.5, lost)
    assert found.open_edges == 0
    assert found.volume == pytest.approx(whole.volume, rel=1e-12)
