"""The laws of an edge grow together where deviations gather beside it."""

from types import SimpleNamespace

import numpy as np
import pytest

from bladewright.fitting.model_selection.growth import EDGE_LAWS, edge_steps
from bladewright.fitting.model_selection.steps import MOST_CURVE, MOST_SPAN
from bladewright.fitting.model_selection.structure import structure_of
from machines import example

STATOR = example("compressor-stator")
U = np.linspace(0.0, 1.0, 101)


def found(distances, design=STATOR):
    """As much of a match as steps look at: points evenly along the chord, and how far off they are."""
    on = SimpleNamespace(u=U, distances=np.asarray(distances))
    return SimpleNamespace(design=design, state=SimpleNamespace(footpoints=on), rows=np.ones(101, dtype=bool))


@pytest.mark.parametrize(("edge", "near"), [("leading_edge", U < 0.03), ("trailing_edge", U > 0.97)])
def test_an_edge_beside_which_deviations_gather_has_all_its_laws_grow(edge, near):
    (step,) = edge_steps(found(np.where(near, 2.0, 0.1)), 1.0)
    before, after = structure_of(STATOR), step.structure
    grown = {name for name in before.span if after.span[name] > before.span[name]}
    assert grown == set(EDGE_LAWS[edge])
    assert [name for name in before.channel if after.channel[name] > before.channel[name]] == [edge]
    laws = sum(after.span[name] - before.span[name] for name in EDGE_LAWS[edge])
    assert step.parameters == laws + 2 * (after.channel[edge] - before.channel[edge])


def test_no_edge_grows_where_all_is_kept_or_deviations_lie_elsewhere():
    assert edge_steps(found(np.full(101, 0.5)), 1.0) == []
    assert edge_steps(found(np.where(np.abs(U - 0.5) < 0.02, 2.0, 0.1)), 1.0) == []
    # a blade that is not matched yet
    assert edge_steps(found(np.full(101, 2.0)), 1.0) == []


def test_laws_of_edges_grow_up_to_a_limit():
    at_edges = found(np.where((U < 0.03) | (U > 0.97), 2.0, 0.1))
    for step in edge_steps(at_edges, 1.0):
        assert max(step.structure.span.values()) <= MOST_SPAN
        assert max(step.structure.channel.values()) <= MOST_CURVE
