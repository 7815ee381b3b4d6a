"""Designs drawn at random: what cannot be built is refused with a reason, the rest passes its round trip.

The slow test does the same for 2,000 of them, and so does `python design/random_designs.py --count 2000`.
"""

import pytest
import random_designs

KINDS = {
    ("unified", 3): "refused",
    ("unified", 7): "refused",
    ("unified", 9): "refused",
    ("unified", 22): "built",
    ("unified", 12): "refused",
    ("sections", 0): "refused",
    ("sections", 2): "refused",
    ("sections", 3): "built",
    ("sections", 5): "refused",
    ("parts", 0): "refused",
    # its fillet folds between the first places that are looked at
    ("parts", 92): "refused",
}
"""of designs by their seeds: refused for different reasons, or built, with a passage that fills its ring"""


@pytest.mark.parametrize(
    ("of", "seed"), [pytest.param(*each, marks=[pytest.mark.slow] if each == ("parts", 92) else []) for each in KINDS]
)
def test_each_random_design_is_refused_with_a_reason_or_passes_its_round_trip(of, seed, tmp_path):
    kind, why = random_designs.judged(seed, tmp_path, samples=500, of=of)
    assert kind == KINDS[of, seed], why


@pytest.mark.slow
@pytest.mark.parametrize(
    ("of", "count", "failing"), [("unified", 2000, [785]), ("sections", 500, []), ("parts", 200, [])]
)
def test_each_of_many_random_designs_is_refused_with_a_reason_or_passes_its_round_trip(of, count, failing):
    # of 785, whose side all but has a cusp, the kernel takes the end for one that crosses itself: no file is written
    found = {
        o.seed: o for o in random_designs.outcomes(range(count), jobs=2, of=of) if o.kind not in random_designs.FINE
    }
    assert list(found) == failing, found


def test_a_random_design_follows_from_its_seed_alone():
    for drawn in random_designs.DRAWN.values():
        assert drawn.random_design(7) == drawn.random_design(7)
        assert drawn.random_design(7) != drawn.random_design(8)


def test_what_became_of_a_design_comes_back_from_its_process():
    (found,) = random_designs.outcomes([13])
    assert (found.seed, found.kind) == (13, "refused")


def test_a_design_that_takes_too_long_is_a_hang_and_the_next_one_is_built_all_the_same():
    found = {o.seed: o for o in random_designs.outcomes([0, 10], limit=0.05)}
    assert [found[seed].kind for seed in (0, 10)] == ["hung", "hung"]


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
