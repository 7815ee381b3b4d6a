"""What is built goes to other processes and back, the same to the bit and still unchangeable, named in a line."""

import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import bladewright
from bladewright.frozen import FrozenMapping
from bladewright.section.laws import Span
from machines import COARSE, built
from machines.coarse import BLADES
from machines.families import FAMILIES
from machines.passages import passage_case
from machines.sectioned import DESIGNS
from machines.sections import EXAMPLES
from machines.thickness_laws import LAWS
from machines.unified import VANE

PASSAGES = ("cascade", "plate with faces at both edges")
SECTIONS = {name: design for name, design in FAMILIES.items() if name.endswith("-section")}


def coarse(design):
    return design.changed("tolerance", COARSE)


def copies(thing):
    return [pickle.loads(pickle.dumps(thing)), copy.deepcopy(thing)]


def nets(shapes):
    """Control points by name of surfaces or curves."""
    return {name: getattr(shape, "surface", shape).control_points for name, shape in shapes.items()}


def same(shapes, others):
    mine, theirs = nets(shapes), nets(others)
    assert [*mine] == [*theirs]
    for name, net in mine.items():
        np.testing.assert_array_equal(theirs[name], net)
        assert not theirs[name].flags.writeable


@pytest.mark.parametrize("name", ["rotor", "cleared", *DESIGNS])
def test_a_blade_and_its_sections_survive_a_pickle_and_a_copy(name):
    design = BLADES[name] if name in BLADES else coarse(DESIGNS[name])
    blade = built(design)
    volume, section = blade.properties.volume, blade.sections[1]
    for other in copies(blade):
        same(blade.surfaces, other.surfaces)
        assert other.design == design
        assert other.properties.volume == volume
        assert not other.knots.u.flags.writeable
        with pytest.raises(FrozenInstanceError):
            other.chord = 1.0
        with pytest.raises(TypeError):
            other.surfaces["upper"] = None
    for other in copies(section):
        same(section.curves, other.curves)
        assert other.area == section.area


@pytest.mark.parametrize("name", list(SECTIONS))
def test_a_section_of_every_family_survives_a_pickle_and_a_copy(name):
    section = built(SECTIONS[name])
    area = section.area
    for other in copies(section):
        same(section.curves, other.curves)
        assert other.area == area
        np.testing.assert_array_equal(other.thickness, section.thickness)


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_the_outline_of_every_section_survives_a_pickle_and_a_copy(name):
    outline, s = EXAMPLES[name].part().outline(Span(np.zeros(1))), np.linspace(0.0, 1.0, 23)
    points, joints = outline.points(s), outline.joints
    for other in copies(outline):
        np.testing.assert_array_equal(other.points(s), points)
        assert other.joints == joints


@pytest.mark.parametrize("name", list(LAWS))
def test_every_thickness_law_survives_a_pickle_and_a_copy(name):
    thickness, places = LAWS[name].at(Span(np.array([0.0, 0.6]))), np.linspace(0.02, 0.98, 23)
    half = thickness.series(places, 0)[1].value
    for other in copies(thickness):
        np.testing.assert_array_equal(other.series(places, 0)[1].value, half)


@pytest.mark.parametrize("name", PASSAGES)
def test_a_passage_survives_a_pickle_and_a_copy(name):
    passage = passage_case(name).passage
    for other in copies(passage):
        same(passage.surfaces, other.surfaces)
        assert other.folds == passage.folds
        assert other.ring == passage.ring


def test_a_fresh_process_builds_a_blade_and_sends_it_back():
    design = BLADES["rotor"]
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        sent = pool.submit(design.build).result(timeout=120)
        section = pool.submit(sent.section, 0.3).result(timeout=120)
    same(built(design).surfaces, sent.surfaces)
    same(built(design).section(0.3).curves, section.curves)


def test_fits_of_plain_curves_and_surfaces_survive_a_pickle_and_a_copy():
    t = np.linspace(0.0, 1.0, 30)
    curve = bladewright.fit_curve(np.stack([t, t**2], axis=-1), control_points=4)
    u, v = (each.ravel() for each in np.meshgrid(t[::3], t[::3]))
    surface = bladewright.fit_surface(np.stack([u, v, u * v], axis=-1), control_points=(4, 4))
    for fit in (curve, surface):
        for other in copies(fit):
            np.testing.assert_array_equal(other.distances, fit.distances)
    same({"": curve.curve}, {"": copies(curve)[0].curve})
    same({"": surface.surface}, {"": copies(surface)[0].surface})


def test_a_net_jacobian_survives_a_pickle_and_a_copy():
    jacobian = bladewright.net_jacobian(VANE)
    for other in copies(jacobian):
        np.testing.assert_array_equal(other.points("upper", 0.3), jacobian.points("upper", 0.3))


def test_a_frozen_mapping_is_a_mapping_that_refuses_changes():
    mapping = FrozenMapping({"upper": 1, "lower": 2})
    assert mapping == {"upper": 1, "lower": 2}
    assert mapping | {"tip": 3} == {"upper": 1, "lower": 2, "tip": 3}
    assert {"tip": 3, "upper": 0} | mapping == {"tip": 3, "upper": 1, "lower": 2}
    assert repr(mapping) == "{'upper': 1, 'lower': 2}"
    assert copies(mapping) == [mapping, mapping]
    with pytest.raises(TypeError):
        mapping["upper"] = 0


@pytest.mark.parametrize("name", ["rotor", "cleared", *DESIGNS])
def test_what_is_built_is_named_in_one_line(name):
    blade = built(BLADES[name] if name in BLADES else coarse(DESIGNS[name]))
    line = repr(blade)
    assert all(
        word in line for word in (blade.name, type(blade.design).__name__, *blade.surfaces, f"{blade.chord:.6g}")
    )
    for thing in (blade, blade.surfaces, blade.sections[1], *blade.surfaces.values()):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 600


def test_a_passage_and_fits_are_named_in_one_line():
    passage = passage_case("cascade").passage
    t = np.linspace(0.0, 1.0, 30)
    curve = bladewright.fit_curve(np.stack([t, t**2], axis=-1), control_points=4)
    assert repr(passage).startswith(f"<Passage '{passage.name}': {len(passage.surfaces)} faces")
    assert repr(curve).startswith("<CurveFit: ")
    assert "30 points" in repr(curve)
    assert repr(curve.curve) == "<Curve: 4 control points, degree 3>"
