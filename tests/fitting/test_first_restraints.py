"""Sections that are drawn through points stay among them."""

import numpy as np
import pytest

from bladewright.fitting.initial_guess.restraints import ALLOWED_GAPS, OVERHANG_WEIGHT, overhang_rows
from bladewright.fitting.initial_guess.section_shape import EXTENT, START, SectionShape, UnwrappedPoints

ROWS = 21
LINES = 13


def plate():
    """Points of a flat plate whose stream lines are two units long, in even rows."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, ROWS), np.linspace(0.0, 1.0, ROWS))
    points = np.stack([2.0 * u.ravel(), np.zeros(u.size)], axis=-1)
    return UnwrappedPoints(points=points, v=v.ravel(), size=np.ones(u.size), chord=2.0, ratio=1.0)


def sections(start, extent):
    shape = SectionShape(
        chordwise=(4, 4),
        samples=8,
        clustering=1.0,
        scale=lambda abscissa, _: np.ones_like(abscissa),
        extent=lambda v: np.full(np.shape(v), 2.0),
    )
    laws = np.zeros((3, shape.columns))
    laws[:, START], laws[:, EXTENT] = start, extent
    return shape, laws


def test_sections_among_the_points_are_left_alone():
    shape, laws = sections(0.0, 1.0)
    rows, aims = overhang_rows(shape, plate(), laws)
    assert rows.shape == (0, shape.columns * len(laws))
    assert aims.shape == (0,)


@pytest.mark.parametrize(("start", "extent", "sign"), [(-0.3, 1.3, 1.0), (0.0, 1.3, -1.0)])
def test_an_end_past_the_points_is_drawn_to_within_the_gaps_between_them(start, extent, sign):
    shape, laws = sections(start, extent)
    rows, aims = overhang_rows(shape, plate(), laws)
    assert len(rows) == LINES
    # two or three rows of points are beside a stream line
    beside = ALLOWED_GAPS / (0.3 - sign * aims / OVERHANG_WEIGHT)
    assert np.all(np.isclose(beside, 2 * ROWS) | np.isclose(beside, 3 * ROWS))
    moved = laws.T.reshape(-1) + np.linalg.pinv(rows) @ aims
    _, left = overhang_rows(shape, plate(), moved.reshape(-1, len(laws)).T)
    # laws of three control points follow the mean of the rooms beside two and three rows
    assert np.max(sign * left, initial=0.0) < 1.5 * OVERHANG_WEIGHT * ALLOWED_GAPS * (
        1.0 / (2 * ROWS) - 1.0 / (3 * ROWS)
    )
