"""Where a blade ends is said to be known where a row of points shows it, and nowhere else."""

from pathlib import Path

import numpy as np
import pytest

from bladewright.files.clouds import read_cloud
from bladewright.fitting.assessment.coverage import largest_gap, loose_ends
from bladewright.fitting.fit import fit
from bladewright.fitting.free_parameters import FreeParameters, free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from machines import example

STATOR = example("aachen-stator")
LS89 = Path(__file__).parents[3] / "shared" / "data" / "clouds" / "LS89_2D.txt"
SPAN = 0.11
"""[m]"""


def ends_of(*rows, free="channel.leading_edge[*].r", noise=0.0):
    """The loose ends of a match of 400 points at random and of rows of 20 at some places along the span."""
    draw, sides = np.random.default_rng(0), STATOR.build().sides
    parts = [side(*draw.random((2, 200))) for side in sides]
    parts += [side(draw.random(20), np.full(20, v)) for side in sides for v in rows]
    points = np.concatenate(parts)
    points += noise * draw.normal(size=points.shape)
    freedom = free_parameters_of(free, None, started=True)
    task = Task(points=points, weights=np.ones(len(points)), free=freedom, bounds={})
    return found_loose(searched(task, STATOR, rounds=1))


def found_loose(match):
    """The loose ends of a match, by its own points."""
    return loose_ends(match, match.state.footpoints.part(match.rows))


@pytest.mark.parametrize(("rows", "loose"), [((0.0, 1.0), set()), ((0.0,), {"shroud"}), ((), {"hub", "shroud"})])
def test_an_end_without_a_row_of_points_is_loose_by_as_much_as_points_are_apart(rows, loose):
    found = ends_of(*rows)
    assert set(found) == loose
    # 400 points at random are a four-hundredth of the span apart along it, within what so few say
    assert all(SPAN / 2000.0 < gap < SPAN / 80.0 for gap in found.values())


@pytest.mark.parametrize(("rows", "loose"), [((0.0, 1.0), set()), ((), {"hub", "shroud"})])
def test_a_row_with_the_noise_of_the_cloud_is_a_row(rows, loose):
    assert set(ends_of(*rows, noise=2e-5)) == loose


def test_an_end_is_known_no_better_than_its_wall_lies_past_the_points():
    draw, corners = np.random.default_rng(0), [f"channel.{edge}[0].r" for edge in ("leading_edge", "trailing_edge")]
    points = np.concatenate([side(*draw.random((2, 400))) for side in STATOR.build().sides])
    further = STATOR.changed({corner: STATOR.parameters()[corner] - 1.0 for corner in corners})
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(free=tuple(corners)))
    true, past = (found_loose(searched(task, each, rounds=0))["hub"] for each in (STATOR, further))
    # 800 points at random are within a few tenths of a millimetre of the hub
    assert 0.9e-3 < past < 1.5e-3
    assert true < 0.7e-3


def test_ends_of_a_channel_that_is_given_are_known():
    assert ends_of(free="stagger") == {}


@pytest.mark.parametrize(("free", "loose"), [("channel.*", {"hub", "shroud"}), ("channel.hub[*].r", set())])
def test_a_row_of_no_more_points_than_its_curve_has_parameters_shows_no_end(free, loose):
    design, draw = example("fan-rotor"), np.random.default_rng(1)
    parts = [side(draw.random(200), 0.1 + 0.8 * draw.random(200)) for side in design.build().sides]
    parts += [side(np.array([0.1, 0.5, 0.9]), np.full(3, v)) for side in design.build().sides for v in (0.0, 1.0)]
    points = np.concatenate(parts)
    freedom = free_parameters_of(free, None, started=True)
    task = Task(points=points, weights=np.ones(len(points)), free=freedom, bounds={})
    assert set(found_loose(searched(task, design, rounds=0))) == loose


@pytest.mark.slow
@pytest.mark.skipif(not LS89.is_file(), reason="the shared clouds are not here")
def test_one_side_of_a_turning_vane_alone_does_not_pass():
    found = fit(read_cloud(LS89).points[:202])
    assert any("one side of a blade alone" in failure for failure in found.failures)


@pytest.mark.parametrize(("parts", "count"), [(1, 20), (4, 60), (12, 60), (6, 600)])
def test_the_largest_gap_is_that_of_95_in_100_clouds(parts, count):
    outermost = np.max(np.random.default_rng(0).random((4000, parts, count // parts)), axis=2)
    within = np.mean(np.max(1.0 - outermost, axis=1) <= largest_gap(count, parts))
    assert within == pytest.approx(0.95, abs=3.0 * np.sqrt(0.95 * 0.05 / 4000))


def test_an_end_whose_parameters_the_points_do_not_determine_is_no_better_known():
    draw, sides = np.random.default_rng(0), STATOR.build().sides
    points = np.concatenate([side(*draw.random((2, 200))) for side in sides])
    freedom = free_parameters_of(("channel.leading_edge[*].r", "channel.trailing_edge[*].r"), None, started=True)
    task = Task(points=points, weights=np.ones(len(points)), free=freedom, bounds={})
    tasks = task, task.holding(["channel.trailing_edge[1].r"])
    gaps = [found_loose(searched(each, STATOR, rounds=0)) for each in tasks]
    assert gaps[1] == pytest.approx(gaps[0])
