"""Each body built once a session, and each of its files written once."""

from functools import cache

import pytest

from bladewright import cad
from bladewright.cad.solids import occ_solid
from machines.closed_forms import BODIES, annular

COARSE = 2e-4
"""[m] of chordal deviation of meshes, for speed"""
MESHES = ("stl", "3mf")


@pytest.fixture(scope="session")
def bodies():
    return {name: build() for name, build in BODIES.items()}


@pytest.fixture(scope="session", params=list(BODIES))
def body(request):
    """The name of each body."""
    return request.param


@pytest.fixture(scope="session")
def built(body, bodies):
    return bodies[body]


@pytest.fixture(scope="session")
def rotor(bodies):
    return bodies["annular"]


@pytest.fixture(scope="session")
def solid(rotor):
    """The kernel's solid of the annular blade, and its faces by name."""
    return occ_solid(rotor)


@pytest.fixture(scope="session")
def filed(bodies, tmp_path_factory):
    """By the name of a body and the ending of a file: the file and its round trip."""
    folder = tmp_path_factory.mktemp("files")

    @cache
    def written(name, ending):
        path = folder / f"{bodies[name].name}.{ending}"
        options = {"chordal_deviation": COARSE, "samples": 900} if ending in MESHES else {}
        return path, cad.write(bodies[name], path, **options)

    return written


@pytest.fixture(scope="session")
def step(filed):
    """A STEP file of the annular blade and its round trip."""
    return filed("annular", "step")


@pytest.fixture(scope="session")
def turned():
    """The annular blade where theta jumps from pi to -pi."""
    return annular(turn=3.1)
