"""Sections of the families that are one part, found again from points."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from bladewright.errors import FitError
from bladewright.fitting.families import sections
from bladewright.fitting.families.closed_blade import section_shape
from bladewright.fitting.families.kinds import FAMILIES, family_of
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import FreeParameters, scales_of
from bladewright.fitting.models.model import model_of, sides_of
from bladewright.section.camber_angle import CamberAngle, CamberAngleSection
from machines.meanlines import BLUNT, on_meanline
from machines.sections import EXAMPLES

FLAT = "curvature meanline, blunt behind"
MEMBERS: dict[str, Any] = {FLAT: on_meanline(curvature=(0.8, 1.0, 0.4), thickness=BLUNT)}
MEMBERS |= {
    name: each.design
    for name, each in EXAMPLES.items()
    # an example of the contract's own tests is of no family; a profile through points has no numbers besides them
    if name != "oval" and not name.startswith("points")
}
STARTED = ("wedge diffuser with a back face", "camber-angle-blunt", "naca-2412")
LIKE = ("suction and pressure side of a stator", FLAT, "naca-2412")
"""with those, one of each family"""
SAMPLED = (*STARTED, *LIKE, "double-circular-arc-sharp", "flat-plate-elliptic", "mixed camber line", "naca-6409-blunt")


@cache
def built(name):
    return MEMBERS[name].build()


def cloud(name, count=150, noise=0.0):
    """Points of a section, those of its faces among them [m]."""
    random = np.random.default_rng(7)
    points = np.concatenate([side(random.random(count)) for side in sides_of(built(name))])
    return random.permutation(points + noise * random.normal(size=points.shape))


def shaken(design, part=0.1):
    """The design with every parameter that a fit finds moved by a part of what matters."""
    paths, values = FreeParameters()(design), design.parameters()
    size = scales_of(design, paths, float(built_chord(design))).size
    random = np.random.default_rng(3)
    steps = part * size * random.uniform(-1.0, 1.0, len(paths))
    return design.changed({path: float(values[path] + step) for path, step in zip(paths, steps, strict=True)})


def built_chord(design):
    return design.chord * 1e-3


@pytest.mark.parametrize("name", MEMBERS)
def test_the_derivatives_of_a_sections_sides_are_those_of_the_sides_built_with_a_difference(name):
    design = MEMBERS[name]
    model, paths = model_of(design, 1e-6), FreeParameters()(design)
    shape = model.shape(design)
    rates = model.rates(shape, paths)[:2]
    values = design.parameters()
    sizes = scales_of(design, paths, model.chord).size
    # every parameter has its own share in the direction, so that none can be wrong unseen
    direction = sizes * np.random.default_rng(5).uniform(0.5, 1.0, len(paths))
    sides = []
    for step in (1e-5, -1e-5):
        changed = {path: float(values[path] + step * way) for path, way in zip(paths, direction, strict=True)}
        sides.append(model.shape(design.changed(changed)).sides)
    for rate, above, below in zip(rates, *sides, strict=True):
        slope = (above.control_points - below.control_points) / 2e-5
        # of second order in the step, 1e-10 of what matters, times derivatives of up to a thousand at small edges
        assert np.tensordot(direction, rate, axes=1) == pytest.approx(slope, abs=1e-6 * model.chord)


@pytest.mark.parametrize("name", sorted(set(SAMPLED)))
def test_a_first_section_is_near_the_section_that_it_is_taken_from(name):
    shape, design = section_shape(built(name)), MEMBERS[name]
    assert shape.chord == pytest.approx(design.chord * 1e-3, rel=1e-9)
    first = family_of(design).first_parts(shape, design.section)[0]
    assert type(first) is type(design.section)
    assert first.parameters().keys() == design.section.parameters().keys()
    again = section_shape(type(design)(name="again", length_unit="mm", chord=design.chord, section=first).build())
    places = np.linspace(0.05, 0.95, 19)
    assert again.half(places) == pytest.approx(shape.half(places), abs=0.03)
    assert again.camber(places) == pytest.approx(shape.camber(places), abs=0.03)


@pytest.mark.parametrize("name", STARTED)
def test_a_section_is_found_again_from_a_start_that_is_off(name):
    found = fit(cloud(name, 60), start=shaken(MEMBERS[name]))
    assert type(found.design) is type(MEMBERS[name])
    # the tolerance of a section's native curves is 1e-10 of its chord
    assert found.maximum < 1e-9 * found.built.chord
    assert found.passed


@pytest.mark.parametrize("name", [FLAT, *(pytest.param(name, marks=pytest.mark.slow) for name in LIKE if name != FLAT)])
def test_a_section_is_found_again_when_its_structure_is_given(name):
    design = MEMBERS[name]
    found = fit(cloud(name, 60), family=family_of(design).name, like=design)
    assert found.maximum < 1e-9 * found.built.chord
    assert found.passed
    truth = design.parameters()
    for each in found.estimates:
        # control points of the second derivative count by their ratios alone
        if not each.path.startswith("section.curvature["):
            assert each.value == pytest.approx(truth[each.path], rel=1e-5, abs=1e-7), each.path


def test_points_on_a_blunt_face_are_said_to_be_there():
    name = "camber-angle-blunt"
    found = fit(cloud(name, 400), start=MEMBERS[name])
    assert set(found.places) == {"upper", "lower", "trailing_edge"}
    assert set(found.regions[found.places == "trailing_edge"]) == {"trailing edge"}


def test_a_vane_is_found_from_its_points_and_its_familys_name_alone():
    design = MEMBERS["wedge diffuser with a back face"]
    found = fit(cloud("wedge diffuser with a back face"), family="wedge-diffuser")
    assert found.maximum < 1e-6 * found.built.chord
    assert found.design.section.parameters() == pytest.approx(design.section.parameters(), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "count"), [(3, 150), (0, 350)])
def test_a_blunt_edge_is_found_that_a_search_from_behind_it_leaves_out_of_the_points(seed, count):
    part = CamberAngle(
        camber_angle=(-0.258, 8.92, 7.24), half_thickness=(0.00877, 0.01198, 0.01216, 0.00795), trailing_edge="blunt"
    )
    design = CamberAngleSection(name="blunt", length_unit="mm", chord=43.08, section=part)
    random = np.random.default_rng(seed)
    points = np.concatenate([side(random.random(count)) for side in sides_of(design.build())])
    found = fit(points, family="camber-angle")
    assert found.passed
    assert found.maximum < 1e-9 * found.built.chord


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"family": "camber-angel"}, "did you mean 'camber-angle'|camber-angle"),
        ({"family": "camber-angle", "like": MEMBERS["naca-2412"]}, "CamberAngleSection of the family camber-angle"),
        ({"family": "profile", "parameters": 2}, "from 4 to 2000"),
        ({"start": MEMBERS["naca-2412"], "free": "section.wedge_angle"}, "section.wedge_angle"),
    ],
)
def test_what_is_wrong_is_said_in_one_paragraph(options, said):
    with pytest.raises(FitError, match=said) as refusal:
        fit(cloud("naca-2412"), **options)
    assert "\n" not in str(refusal.value)


def test_a_sections_family_has_no_points_in_space():
    points = np.random.default_rng(0).random((200, 3))
    for name in FAMILIES:
        with pytest.raises(FitError, match="give x and y alone"):
            fit(points, family=f"{name}-section")


def test_a_first_design_that_meets_all_points_is_searched_from(monkeypatch):
    # of a misfit of nothing all others are infinite multiples
    monkeypatch.setattr(sections, "misfits", lambda trials: [0.0, *[1.0] * (len(trials) - 1)])
    assert fit(cloud("naca-2412"), family="profile").passed
