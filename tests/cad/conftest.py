"""Each body built once a session, and each of its files written once."""

import pytest

from bladewright import cad
from machines.closed_forms import BODIES, annular

ENDINGS = ("step", "stp", "igs", "iges", "brep")


@pytest.fixture(scope="session")
def bodies():
    return {name: build() for name, build in BODIES.items()}


@pytest.fixture(scope="session", params=list(BODIES))
def built(request, bodies):
    return bodies[request.param]


@pytest.fixture(scope="session")
def rotor(bodies):
    return bodies["annular"]


@pytest.fixture(scope="session")
def step(rotor, tmp_path_factory):
    """A STEP file of the annular blade and its round trip."""
    path = tmp_path_factory.mktemp("step") / "rotor.step"
    return path, cad.write(rotor, path)


@pytest.fixture(scope="session")
def turned():
    """The annular blade where theta jumps from pi to -pi."""
    return annular(turn=3.1)
