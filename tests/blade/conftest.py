"""Each machine in turn, built once a session."""

import pytest

from machines import built
from machines.unified import DESIGNS


@pytest.fixture(scope="session", params=list(DESIGNS))
def design(request):
    return DESIGNS[request.param]


@pytest.fixture(scope="session")
def blade(design):
    return built(design)
