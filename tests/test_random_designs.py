"""Designs drawn at random: what cannot be built is refused with a reason, the rest passes its round trip.

The slow test does the same for 2,000 of them, and so does `python design/random_designs.py --count 2000`.
"""

import sys
from collections import Counter
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "design"))
import random_designs

COUNT = 36


@pytest.fixture(scope="module")
def outcomes():
    """What became of the designs of the first seeds, each built in a process that may die."""
    return list(random_designs.outcomes(range(COUNT), samples=1000))


def test_each_random_design_is_refused_with_a_reason_or_passes_its_round_trip(outcomes):
    assert sorted(outcome.seed for outcome in outcomes) == list(range(COUNT))
    assert [outcome for outcome in outcomes if outcome.kind not in random_designs.FINE] == []


@pytest.mark.slow
def test_each_of_two_thousand_random_designs_is_refused_with_a_reason_or_passes_its_round_trip():
    found = random_designs.outcomes(range(2000), jobs=2)
    assert [outcome for outcome in found if outcome.kind not in random_designs.FINE] == []


def test_a_fair_share_of_random_designs_is_built_and_another_refused(outcomes):
    kinds = Counter(outcome.kind for outcome in outcomes)
    assert kinds["built"] + kinds["blade only"] >= COUNT // 4
    # each with a passage that fills its ring
    assert kinds["built"] >= COUNT // 8
    assert kinds["refused"] >= COUNT // 4
    assert len({outcome.shape for outcome in outcomes if outcome.kind == "built"}) >= 3


def test_a_random_design_follows_from_its_seed_alone():
    for drawn in random_designs.DRAWN.values():
        assert drawn.random_design(7) == drawn.random_design(7)
        assert drawn.random_design(7) != drawn.random_design(8)


def test_a_design_that_takes_too_long_is_a_hang_and_the_next_one_is_built_all_the_same():
    found = {o.seed: o for o in random_designs.outcomes([0, 1], limit=0.05)}
    assert [found[seed].kind for seed in (0, 1)] == ["hung", "hung"]


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("stagger is 91: an angle must lie between -90 and 90 deg", ""),
        ("something is wrong with this design, which cannot be built", "names no parameter"),
        ("stagger is 91: an angle must lie\nbetween -90 and 90 deg", "not one paragraph"),
        ("stagger is wrong", "not one paragraph"),
    ],
)
def test_a_refusal_must_be_one_paragraph_that_names_a_parameter(message, wrong):
    assert random_designs.unclear(message) == wrong
