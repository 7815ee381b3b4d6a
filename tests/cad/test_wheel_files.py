"""Files of a sector and of a wheel: one closed solid each, with the names and the volume of the native faces."""

from dataclasses import replace

import pytest

from bladewright import cad
from bladewright.blade.design.disc import Disc, Outline
from bladewright.blade.design.fillet import Fillet
from bladewright.domain.sector import sector
from bladewright.domain.wheel import wheel
from machines import coarse

WEB = ((-8.0, 94.0), (-8.0, 60.0), (97.0, 60.0), (97.0, 118.5))
SAMPLES = 300


ROTOR = replace(coarse.ROTOR, blade_count=2, disc=Disc(outline=Outline(points=WEB, radii=(5.0, 0.0))))


@pytest.mark.parametrize(
    "built",
    [
        pytest.param(lambda: sector(ROTOR.build()), id="sector"),
        pytest.param(
            lambda: wheel(replace(ROTOR, hub_fillet=Fillet(radius=2.0), shroud_ring=Disc(thickness=2.0)).build()),
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
