"""A blade of segmented airfoils whose edges bend by another angle at every span leaves as a proven file."""

import pytest

from bladewright import cad
from bladewright.domain.build import passage
from machines import built
from machines.sectioned import MORPHING

BLADE = MORPHING.changed("tolerance", 1e-5)


@pytest.mark.slow
def test_a_morphed_blade_and_its_passage_survive_the_round_trip(tmp_path):
    blade = built(BLADE)
    assert blade.conformance.kept
    for body in (blade, passage(blade)):
        trip = cad.write(body, tmp_path / f"{body.name}.step")
        assert trip.passed, trip.failures
