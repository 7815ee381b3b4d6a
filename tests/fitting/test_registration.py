"""Clouds that lie anywhere are brought onto a design, or into machine axes that are named or shown."""

from contextlib import suppress

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bladewright.errors import DesignError, FitError
from bladewright.fitting.assessment.result import Motion
from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task
from bladewright.fitting.placing import PlacedTask, placed_nearest
from bladewright.fitting.registration import axis_motion, found_axes, registrations
from machines import COARSE, built, example


def design_of(name):
    """A built-in design at a tolerance at which samples and footpoints cost less."""
    return example(name).changed("tolerance", COARSE)


def cloud(name, count, *, span=(0.0, 1.0)):
    """Points of both sides, a tenth of them in rows at the two ends."""
    random = np.random.default_rng(7)
    v = span[0] + (span[1] - span[0]) * random.random(count // 2)
    v[: count // 20] = np.where(random.random(count // 20) < 0.5, *span)
    return np.concatenate([side(random.random(count // 2), v) for side in built(design_of(name)).sides])


def rows(name, along, across):
    """A grid of points on both sides, rows at the ends among them."""
    u, v = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, along))) / 2.0, np.linspace(0.0, 1.0, across)
    return np.concatenate([side.grid(u, v).reshape(-1, 3) for side in built(design_of(name)).sides])


def thrown(seed):
    random = np.random.default_rng(seed)
    return Motion(rotation=Rotation.random(rng=random).as_matrix(), translation=random.normal(size=3))


@pytest.mark.parametrize("name", ["radial-turbine", pytest.param("vki-ls89", marks=pytest.mark.slow)])
def test_points_of_the_design_itself_are_moved_back_within_a_billionth_of_the_chord(name):
    points = cloud(name, 1200)
    motion, notes = registrations(thrown(1)(points), design_of(name))[0]
    # what was asked of noise-free points
    assert np.abs(motion(thrown(1)(points)) - points).max() < 1e-9 * built(design_of(name)).chord
    assert not notes


def test_half_a_span_with_noise_and_outliers_is_put_where_it_belongs():
    points, random = cloud("fan-rotor", 500, span=(0.3, 0.8)), np.random.default_rng(3)
    noisy = points + 2e-5 * random.normal(size=points.shape)
    box = noisy.min(axis=0) + np.ptp(noisy, axis=0) * (1.6 * random.random((25, 3)) - 0.3)
    motion, notes = registrations(thrown(2)(np.concatenate([noisy, box])), design_of("fan-rotor"))[0]
    # the middle of the blade is found far within the noise of a point
    error = (motion(thrown(2)(points)) - points).mean(axis=0)
    assert np.max(np.sqrt(error**2)) < 0.5 * 2e-5
    assert not notes


def shaken(name, seed):
    """The design with every parameter but those of its channel 3 % off, drawn until it can be built."""
    random, design = np.random.default_rng(seed), design_of(name)
    own = {path: value for path, value in design.parameters().items() if not path.startswith("ch")}
    while True:
        values = {path: value * (1.0 + 0.03 * random.normal()) for path, value in own.items()}
        with suppress(DesignError):
            design.changed(values).build()
            return design.changed(values)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), [("aachen-stator", 101), ("propeller", 100)])
def test_a_start_whose_shape_is_off_has_the_right_way_among_those_about_as_near(name, seed):
    """A prism is not thrown along its span; a flat blade turned over may be nearer than as it is."""
    points = rows(name, 40, 15)
    ways = registrations(thrown(1)(points), shaken(name, seed))
    turns = [(motion.rotation @ thrown(1).rotation) for motion, _ in ways]
    assert max(np.trace(each) for each in turns) > 3.0 - 0.01
    assert any(np.trace(each) < 0.0 for each in turns) is (name == "propeller")


def test_of_ways_about_as_near_the_one_is_taken_that_the_shape_follows_best():
    design, points = (
        example("turbine-section"),
        np.concatenate(
            [np.real(curve(np.linspace(0.0, 1.0, 100))) for curve in example("turbine-section").build().curves.values()]
        ),
    )
    middle = np.mean(points, axis=0)
    over = Motion(rotation=-np.eye(2), translation=2.0 * middle)
    same = Motion(rotation=np.eye(2), translation=np.zeros(2))
    free = free_parameters_of(None, None, started=True)

    def place(motion, start, notes):
        task = Task(points=motion(points), weights=np.ones(len(points)), free=free, bounds={})
        return PlacedTask(motion=motion, notes=notes, start=start, every=task, shown=task, hidden=None)

    off = design.changed("stagger", design.stagger + 1.0)
    assert placed_nearest([(over, ("over",)), (same, ())], off, place).motion is same
    assert placed_nearest([(over, ("over",))], off, place).notes == ("over",)


def test_motions_are_compared_with_the_walls_and_edges_of_a_start(monkeypatch):
    """Rows of points of a blade that lies wrong drew its shroud to the row beside its own: the right way seemed off."""
    design, freed = example("aachen-stator"), list[set[str]]()

    def searched_with(task, start, **_):
        freed.append(set(task.free(start)))
        raise FitError

    def place(motion, start, notes):
        task = Task(points=points, weights=np.ones(len(points)), free=free)
        return PlacedTask(motion=motion, notes=notes, start=start, every=task, shown=task, hidden=None)

    monkeypatch.setattr("bladewright.fitting.placing.searched", searched_with)
    points = np.concatenate([side(*np.random.default_rng(0).random((2, 20))) for side in design.build().sides])
    for given, curves in ((None, False), (("channel.leading_edge[*].r",), True)):
        free = free_parameters_of(given, None, started=True)
        placed_nearest([(None, ("one",)), (None, ("other",))], design, place)
        assert any(path.startswith("channel.") for path in freed[-1]) is curves
        assert freed[-1]


@pytest.mark.slow
def test_a_mirrored_blade_is_told_from_the_design():
    points = cloud("radial-turbine", 800) * np.array([1.0, -1.0, 1.0])
    assert "another blade" in " ".join(registrations(thrown(4)(points), design_of("radial-turbine"))[0][1])


@pytest.mark.slow
def test_a_blade_of_another_stagger_is_told_from_the_design():
    other = built(design_of("vki-ls89")).design.changed("stagger", -50.0).build()
    points = np.concatenate([side.grid(np.linspace(0.0, 1.0, 20), np.linspace(0.0, 1.0, 6)) for side in other.sides])
    assert "another blade" in " ".join(registrations(points.reshape(-1, 3), design_of("vki-ls89"))[0][1])


def test_a_prism_without_its_ends_leaves_the_shift_along_the_span_undetermined():
    points = cloud("vki-ls89", 800, span=(0.3, 0.7))
    (note,) = registrations(thrown(5)(points), design_of("vki-ls89"))[0][1]
    assert "do not determine shift_z of" in note


def test_a_section_is_found_in_its_plane():
    design = example("turbine-section")
    u = np.linspace(0.0, 1.0, 150)
    points = np.concatenate([curve(u) for curve in design.build().curves.values()])
    c, s = np.cos(2.0), np.sin(2.0)
    away = Motion(rotation=np.array([[c, -s], [s, c]]), translation=np.array([0.3, -0.1]))
    back, _ = registrations(away(points), design)[0]
    assert np.abs(back(away(points)) - points).max() < 1e-9 * 0.03


@pytest.mark.parametrize("points", ["strewn", pytest.param("rows", marks=pytest.mark.slow)])
def test_a_prism_shows_the_span_of_its_cascade(points):
    given = cloud("vki-ls89", 4000) if points == "strewn" else rows("vki-ls89", 60, 30)
    motion, notes = found_axes(thrown(6)(given))
    span = (motion.rotation @ thrown(6).rotation)[:, 2]
    # neighbours at other heights make a parabola through a bent piece differ by 1e-4 of the chord or so over the span
    assert np.hypot(*span[:2]) < 1e-3
    moved = motion(thrown(6)(given))
    assert moved[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert np.ptp(moved[:, 0]) == pytest.approx(np.ptp(moved[:, :2], axis=0).max())
    assert moved[:, 1].mean() > 0.0
    assert any("chord" in note for note in notes)


@pytest.mark.parametrize("arrangement", [None, "annular"])
def test_an_annular_blade_without_a_start_is_refused_with_the_cure(arrangement):
    with pytest.raises(FitError, match="--start"):
        found_axes(thrown(3)(rows("compressor-stator", 16, 10)), arrangement=arrangement)


@pytest.mark.parametrize(
    "axis", ["x", "y", "z", "-x", "-Y", "+z", (0.0, 2.0, 0.0), (1.0, -2.0, 0.5), (-1.0, 1e-3, 0.0)]
)
def test_a_named_axis_becomes_x_by_the_smallest_turn(axis):
    names = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "-x": (-1, 0, 0), "-Y": (0, -1, 0), "+z": (0, 0, 1)}
    direction = np.array(names[axis] if isinstance(axis, str) else axis, dtype=float)
    direction /= np.sqrt(direction @ direction)
    turn = axis_motion(axis, 3).rotation
    assert turn @ direction == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-12)
    # the angle of the turn is the one between the axes, and its determinant that of no mirror
    assert np.trace(turn) == pytest.approx(1.0 + 2.0 * direction[0], abs=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    if direction[2] == 0.0:
        assert turn[2] == pytest.approx([0.0, 0.0, 1.0])


def test_only_the_direction_of_an_axis_counts():
    for size in (1e300, 1e-300):
        assert axis_motion((0.0, size, 0.0), 3).rotation == pytest.approx(axis_motion("y", 3).rotation)


@pytest.mark.parametrize("axis", [("a", "b", "c"), (1j, 0.0, 0.0)])
def test_an_axis_of_no_numbers_is_refused(axis):
    with pytest.raises(FitError, match="the numbers of axis are"):
        axis_motion(axis, 3)


@pytest.mark.parametrize("axis", [3, "w", "", "xy", (0.0, 0.0, 0.0), (1.0, 2.0), (np.inf, 0.0, 0.0)])
def test_what_is_no_axis_is_refused(axis):
    with pytest.raises(FitError, match="direction of the machine's axis"):
        axis_motion(axis, 3)
    with pytest.raises(FitError, match="x, y"):
        axis_motion("z", 2)
