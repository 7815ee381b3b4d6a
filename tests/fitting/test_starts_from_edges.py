"""From which of several first matches a search for a structure goes on."""

from types import SimpleNamespace

import pytest

from bladewright.fitting.assessment.acceptance import MatchTarget
from bladewright.fitting.matching.noise import EXACT
from bladewright.fitting.model_selection import selection

NEARER, FURTHER = 0.4 * EXACT, 2.0 * EXACT


def match(name, maximum=0.0):
    return SimpleNamespace(name=name, maximum=maximum, design=name, model=SimpleNamespace(chord=1.0))


@pytest.mark.parametrize(
    ("exact", "reached", "tried", "taken"),
    [
        (True, {"nearest": FURTHER, "other": NEARER}, ["nearest", "other"], "other"),
        (True, {"nearest": FURTHER, "other": 2.0 * FURTHER}, ["nearest", "other"], "nearest"),
        (True, {"nearest": NEARER}, ["nearest"], "nearest"),
        (False, {"nearest": FURTHER}, ["nearest"], "nearest"),
    ],
)
def test_exact_points_that_are_not_met_are_sought_from_the_other_first_matches(
    monkeypatch, exact, reached, tried, taken
):
    seen = []

    def begun(search, _few, _target, first):
        seen.append(first.name)
        return search, first, match(first.name, reached[first.name])

    task = SimpleNamespace(dimension=2, thinned=lambda _: task, preliminary=False)
    stand_ins = {
        "replace": lambda each, **_: each,
        "searched": lambda *_, **__: match("first"),
        "from_edges": lambda *_: iter([match("nearest"), match("other")]),
        "_begun": begun,
        "is_exact": lambda _: exact,
        "corner_radii": lambda _: (),
        "structure_of": lambda _: SimpleNamespace(samples=0),
        "StructureSearch": lambda **_: SimpleNamespace(near_everywhere=lambda rich: rich),
        "determined": lambda _, found: (found, ""),
        "has_systematic_misfit": lambda _: False,
        "trusted_distance": lambda _: 1.0,
    }
    for name, stand_in in stand_ins.items():
        monkeypatch.setattr(selection, name, stand_in)
    found, _ = selection.selected_match(task, match("start"), MatchTarget(), like=None, guessed=True)
    assert (seen, found.name) == (tried, taken)
