"""Each small machine in turn, built once a session."""

import pytest

from machines import built
from machines.coarse import BLADES


@pytest.fixture(scope="session", params=list(BLADES))
def design(request):
    return BLADES[request.param]


@pytest.fixture(scope="session")
def blade(design):
    return built(design)
