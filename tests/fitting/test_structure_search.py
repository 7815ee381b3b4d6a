"""How the structure of fewest parameters is found, with predictions and searches stood in by numbers of parameters."""

from itertools import chain, repeat
from types import SimpleNamespace

import pytest

from bladewright.errors import DesignError
from bladewright.fitting.assessment.acceptance import MatchTarget
from bladewright.fitting.model_selection import structure_search
from bladewright.fitting.model_selection.structure_search import MOST_PREDICTIONS, WORTHWHILE, StructureSearch

RICH = 40


def match(count, maximum=None):
    """A match of so many parameters."""
    return SimpleNamespace(problem=SimpleNamespace(paths=range(count)), count=count, maximum=maximum)


@pytest.fixture
def found_by(monkeypatch):
    """Runs the search from a rich match: what it finds, the nearest that fails, and what it searched."""
    monkeypatch.setattr(StructureSearch, "_model", lambda _, match: match)
    monkeypatch.setattr(structure_search, "buildable", lambda _, match: match)
    monkeypatch.setattr(structure_search, "can_be_built", lambda _: True)
    monkeypatch.setattr(StructureSearch, "_widened", lambda _, match, _rounds: SimpleNamespace(**vars(match)))

    def run(predicted, enough, largest, shapeless=()):
        searched = []

        def search(_, prediction):
            searched.append(prediction.parameters)
            count = prediction.parameters
            return None if count in shapeless else match(count, largest(count))

        found, nearest = StructureSearch(task=None, samples=0, first=None)._fewest(
            match(RICH),
            None,
            predicted=lambda about: [
                SimpleNamespace(parameters=n) for n in range(RICH, predicted(about.count) - 1, -1)
            ],
            search=search,
            kept=lambda each: each.count >= enough,
        )
        return found and found.count, nearest and nearest.count, searched

    return run


def test_predictions_about_a_rich_match_that_go_too_far_are_mended_about_the_match_that_they_lead_to(found_by):
    found, nearest, searched = found_by(lambda about: 6 if about == RICH else 12, 12, lambda count: 1.0 / count)
    assert (found, nearest, searched) == (12, 6, [6, 12])


def test_a_match_that_leads_no_nearer_sends_the_search_between_what_failed_and_what_did(found_by):
    # each that fails is further off than the one before, and the rich match, which keeps the aim, is the widest
    found, _, searched = found_by(lambda _: 6, 20, float)
    assert searched[:3] == [6, 7, 22]
    assert 20 <= found < 20 / WORTHWHILE
    assert len(searched) <= MOST_PREDICTIONS


def test_structures_without_a_shape_are_passed_by(found_by):
    found, nearest, searched = found_by(lambda _: 6, 6, lambda count: 1.0 / count, shapeless=range(6, 15))
    assert (found, nearest, searched[:2]) == (16, None, [6, 21])
    assert len(searched) <= MOST_PREDICTIONS


def test_where_nothing_keeps_the_aim_the_nearest_is_given_and_the_search_ends(found_by):
    found, nearest, searched = found_by(lambda _: 30, RICH + 1, lambda count: 1.0 / count)
    assert found is None
    assert nearest == max(searched)
    assert len(searched) <= MOST_PREDICTIONS


def test_a_richer_structure_that_is_no_nearer_ends_the_search_for_rich_ones(monkeypatch):
    task = SimpleNamespace(points=range(100), dimension=3, free=lambda _: ())
    # nearer at its worst place, and further off elsewhere, whenever it is searched
    off = chain([(1e-4, 1e-2)], repeat((2e-4, 1e-3)))
    searched = []

    def search(*_, **__):
        rms, maximum = next(off)
        searched.append(SimpleNamespace(rms=rms, maximum=maximum, design=None, has_systematic_misfit=True))
        if len(searched) > 5:
            raise AssertionError("it is searched for ever")
        return searched[-1]

    for name, stand_in in {
        "searched": search,
        "rich_structure": lambda *_, **__: None,
        "wider_structure": lambda *_, **__: None,
        "widened_where_feasible": lambda design, _: design,
        "evaluated": lambda _, design, **__: SimpleNamespace(design=design),
    }.items():
        monkeypatch.setattr(structure_search, name, stand_in)
    monkeypatch.setattr(StructureSearch, "_is_enough", lambda *_: False)
    monkeypatch.setattr(StructureSearch, "_rows_shown", lambda *_: 1)
    monkeypatch.setattr(StructureSearch, "_without_surplus", lambda _, match, *__: match.design)
    first = SimpleNamespace(rms=1e-3, maximum=1e-1, design=None, model=SimpleNamespace(chord=1.0))
    found = StructureSearch(task=task, samples=0, first=None).rich(first, MatchTarget(tolerance=1e-5))
    assert (found is searched[0], len(searched)) == (True, 2)


@pytest.mark.parametrize(
    ("target", "sampled"),
    [
        (MatchTarget(), True),
        (MatchTarget(tolerance=1e-5), True),
        (MatchTarget(parameters=22), False),
        (MatchTarget(structured=True), False),
    ],
)
def test_a_rich_structure_keeps_to_its_samples_where_neither_number_nor_structure_is_asked(
    monkeypatch, target, sampled
):
    told = []

    def rich_structure(*_, sampled):
        told.append(sampled)
        raise DesignError("no shape")

    monkeypatch.setattr(structure_search, "rich_structure", rich_structure)
    monkeypatch.setattr(StructureSearch, "_rows_shown", lambda *_: 1)
    task = SimpleNamespace(points=range(100), dimension=2, free=lambda _: ())
    first = SimpleNamespace(design=None, model=SimpleNamespace(chord=1.0))
    assert StructureSearch(task=task, samples=0, first=None).rich(first, target) is first
    assert told == [sampled]


@pytest.mark.parametrize(
    ("rich", "found", "again"),
    [(0.95e-4, 1.1e-4, False), (0.6e-4, 1.1e-4, True), (4.5e-4, 4.9e-4, False), (4.5e-4, 5.5e-4, True)],
)
def test_a_match_is_sought_again_where_it_is_clearly_further_off_than_the_rich_one(monkeypatch, rich, found, again):
    largest = {"rich": rich, "found": found, "nearer": 0.9 * found}
    of = {
        name: SimpleNamespace(
            maximum=distance, model=SimpleNamespace(chord=1.0), design=None, has_systematic_misfit=True
        )
        for name, distance in largest.items()
    }
    monkeypatch.setattr(structure_search, "can_be_built", lambda _: True)
    monkeypatch.setattr(StructureSearch, "well_predicted", lambda *_: of["found"])
    monkeypatch.setattr(StructureSearch, "within", lambda *_: (of["nearer"], ""))
    search = StructureSearch(task=None, samples=0, first=None)
    assert search.near_everywhere(of["rich"]) is of["nearer" if again else "found"]


@pytest.mark.parametrize(("exact", "needed", "fewest"), [(True, 38, 12), (True, 20, 20), (False, 38, 38)])
def test_exact_points_that_need_nearly_every_control_point_are_met_nearly(monkeypatch, exact, needed, fewest):
    # fewer control points than the noise needs leave more than it, and fewer than 12 more than 1e-4 somewhere
    at_noise, near, far = (1e-9, 1e-8), (1e-6, 3e-5), (1e-4, 1e-3)
    left = {n: at_noise if n >= needed else near if n >= 12 else far for n in range(RICH, 8, -1)}
    predictions = [SimpleNamespace(parameters=n, deviation=d, largest=most) for n, (d, most) in left.items()]
    rich, offered, none = match(RICH, 1e-8), [], []
    rich.has_systematic_misfit, rich.is_exact = False, exact
    model = SimpleNamespace(match=rich, counts=(), points=1000, prediction=lambda _: predictions[0])
    narrow = SimpleNamespace(match=match(20, 1e-5))
    monkeypatch.setattr(structure_search, "eliminated", lambda at, _: predictions if at is model else predictions[-1:])
    monkeypatch.setattr(StructureSearch, "_model", lambda *_: model)
    monkeypatch.setattr(
        StructureSearch,
        "_fewest",
        lambda *_, predicted, **__: (none.extend(predicted(narrow)), offered.extend(predicted(model))),
    )
    StructureSearch(task=None, samples=0, first=None).well_predicted(rich)
    assert min(each.parameters for each in offered) == fewest
    # about a narrower match nothing may be predicted to reach the aim
    assert none == []
