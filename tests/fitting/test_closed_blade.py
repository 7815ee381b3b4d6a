"""The closed blade whose sections those of a family begin as, rich where few control points do not follow it."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.blade.design.sectioned import SectionedBlade
from bladewright.fitting.families.first_blades import (
    LAW_COUNT,
    RICH_LAW_COUNT,
    SECTION_SPANS,
    closed_blades,
    part_of_laws,
    with_mean_laws,
)
from bladewright.fitting.families.kinds import DesignHeader
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.initial_guess.blade import first_blades
from bladewright.fitting.matching.footpoints import nearest_footpoints
from bladewright.fitting.matching.search import Task
from bladewright.fitting.models.model import model_of, sides_of
from bladewright.section.laws import Span
from machines.sectioned import VANE

WAVES = (6.0, -6.0, 6.0, -6.0, 6.0, -6.0)
"""what the stagger angle of a blade changes by along its span [deg]"""


def wavy(blade: SectionedBlade) -> SectionedBlade:
    section = with_mean_laws(blade.section)
    turned = section.changed({"stagger_angle": tuple(section.stagger_angle + np.array(WAVES))})
    return replace(blade, section=turned, tolerance=1e-4)


def test_laws_of_more_control_points_follow_sections_that_change_much_along_the_span() -> None:
    part = wavy(VANE).section
    angles = Span(SECTION_SPANS).values(part.stagger_angle)
    parts = [with_mean_laws(part).changed({"stagger_angle": float(angle)}) for angle in angles]
    few, many = (part_of_laws(parts, count).stagger_angle for count in (LAW_COUNT, RICH_LAW_COUNT))
    few_off, many_off = (np.max(np.abs(Span(SECTION_SPANS).values(law) - angles)) for law in (few, many))
    assert many_off < 0.2 * few_off


@pytest.mark.slow
def test_a_blade_that_changes_much_along_its_span_begins_as_a_rich_closed_one() -> None:
    blade, draw = wavy(VANE), np.random.default_rng(4)
    built = blade.build()
    points = np.concatenate([side(*draw.random((2, 1500))) for side in sides_of(built)])
    task = Task(points=points, weights=np.ones(len(points)), free=FreeParameters(), bounds={})
    begun = next(first_blades(points, DesignHeader(name="blade", length_unit="mm").known()))
    (closed, count), *others = closed_blades(task, begun)
    assert [count, *(each for _, each in others)] == [RICH_LAW_COUNT, LAW_COUNT, LAW_COUNT]
    sides = model_of(closed).shape(closed).sides
    assert np.max(nearest_footpoints(task.turned(begun.turn).points, sides).distances) < 5e-3 * built.chord
