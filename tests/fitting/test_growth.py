"""Which law is given more control points."""

from dataclasses import replace

import numpy as np
import pytest

from bladewright.fitting.free_parameters import free_parameters_of
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.model_selection.steps import gains, steps_taken_together, steps_up, union_of
from bladewright.fitting.model_selection.structure import parameter_count, structure_of
from bladewright.section.laws import law_basis
from machines import example


def found(truth, start, *, rounds, count=150):
    """A match of points of a design's sides, from a start."""
    built, random = truth.build(), np.random.default_rng(2)
    if hasattr(built, "sides"):
        points = np.concatenate([side(*random.random((2, count))) for side in built.sides])
    else:
        points = np.concatenate([built.curves[side](random.random(count)) for side in ("upper", "lower")])
    task = Task(
        points=points, weights=np.ones(len(points)), free=free_parameters_of(None, None, started=True), bounds={}
    )
    return searched(task, start, rounds=rounds, noise=1e-3)


def nearest(values, count):
    """The law of so many control points that is nearest to one with more."""
    v = np.linspace(0.0, 1.0, 101)
    found, *_ = np.linalg.lstsq(law_basis(count, v), law_basis(len(values), v) @ np.array(values), rcond=None)
    return tuple(float(value) for value in found)


@pytest.mark.parametrize("side", ["thickness_upper", "thickness_lower"])
def test_the_side_that_is_short_of_a_control_point_is_ranked_first(side):
    base, bump = example("turbine-section"), (0.045, 0.15, 0.22, 0.13, 0.1, 0.02)
    match = found(replace(base, **{side: bump}), replace(base, **{side: nearest(bump, 5)}), rounds=0)
    ranked = gains(match)
    assert [len(step.fields) for _, step in ranked] == [1, 1]
    assert ranked[0][1].fields == (side,)
    assert ranked[0][0] > 1.5 * ranked[1][0] > 0.0


@pytest.mark.parametrize(
    ("field", "values"), [("stagger", (18.0, 28.0, 16.0, 25.0)), ("metal_angle_in", (40.0, 52.0, 36.0, 48.0))]
)
def test_the_law_along_the_span_that_is_short_of_a_control_point_is_ranked_first(field, values):
    base = example("compressor-stator")
    match = found(replace(base, **{field: values}), replace(base, **{field: nearest(values, 3)}), rounds=0)
    ranked = gains(match)
    assert ranked[0][1].fields == (field,)
    assert [gain / step.parameters for gain, step in ranked] == sorted(
        (gain / step.parameters for gain, step in ranked), reverse=True
    )


def test_steps_add_the_parameters_that_they_state():
    for name in ("turbine-section", "compressor-stator"):
        base = structure_of(example(name))
        steps = steps_up(base)
        assert len(steps) == (2 if name == "turbine-section" else len(base.span) + len(base.channel) + 2)
        for step in steps:
            assert parameter_count(step.structure) - parameter_count(base) == step.parameters


def test_joined_steps_are_all_taken():
    base = structure_of(example("compressor-stator"))
    steps = [step for step in steps_up(base) if not step.fields[0].startswith("thickness")]
    assert parameter_count(union_of(base, steps)) - parameter_count(base) == sum(step.parameters for step in steps)


def test_what_is_taken_is_worth_it_and_not_more_than_is_left():
    steps = steps_up(structure_of(example("compressor-stator")))
    ranked = sorted(zip([1.0, 8.0, 0.1, 7.0], steps, strict=False), key=lambda pair: -pair[0] / pair[1].parameters)
    taken = steps_taken_together(ranked)
    assert taken[0] is ranked[0][1]
    assert ranked[-1][1] not in taken
    for left in (1, 2, 5):
        assert sum(step.parameters for step in steps_taken_together(ranked, left)) <= left
    assert steps_taken_together([]) == []


def test_laws_that_are_held_do_not_grow():
    base = example("turbine-section")
    points = np.concatenate([base.build().curves[side](np.linspace(0.0, 1.0, 99)) for side in ("upper", "lower")])
    free = free_parameters_of(None, ("thickness_upper[*]",), started=True)
    match = searched(Task(points=points, weights=np.ones(198), free=free, bounds={}), base, rounds=0, noise=1e-3)
    assert [step.fields for _, step in gains(match)] == [("thickness_lower",)]
