"""Passages of every kind of machine, built once a session."""

import pytest

from machines.passages import UNIFIED, passage_case


@pytest.fixture(
    scope="session",
    params=[pytest.param(name, marks=[pytest.mark.slow] if name == "cantilevered stator" else []) for name in UNIFIED],
)
def case(request):
    return passage_case(request.param)


@pytest.fixture(scope="session")
def rotor():
    return passage_case("rotor")


@pytest.fixture(scope="session")
def cascade():
    return passage_case("cascade")


@pytest.fixture(scope="session")
def fan():
    return passage_case("shrouded fan with a gap")


@pytest.fixture(scope="session")
def gapped():
    return passage_case("impeller with a gap")
