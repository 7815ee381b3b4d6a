"""What refusals that name a limit owe: that it is one."""

import re

import pytest

import bladewright as bw


def names_the_largest_radius(asked, words="the largest that holds is", wall="hub"):
    """Whether a blade below the named radius of a wall's fillet is built, and one above it is refused again."""
    with pytest.raises(bw.DesignError, match=words) as refused:
        asked.build()
    largest = float(re.search(r"holds is ([\d.e+-]+)", str(refused.value))[1])
    asked.changed(f"{wall}_fillet.radius", 0.95 * largest).build()
    with pytest.raises(bw.DesignError, match=words):
        asked.changed(f"{wall}_fillet.radius", 1.05 * largest).build()
    return True
