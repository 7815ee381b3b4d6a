"""NACA 23012 by points, and XFOIL where it is installed."""

import shutil

import pytest

import bladewright as bw

NACA_23012 = bw.ProfileSection(
    name="naca-23012", length_unit="m", chord=1.0, section=bw.Naca5(thickness=0.12, trailing_edge="blunt")
)


@pytest.fixture(scope="session")
def section():
    return NACA_23012.build()


@pytest.fixture(scope="session")
def xfoil():
    """Tests that run the real XFOIL are skipped where there is none."""
    if shutil.which("xfoil") is None:
        pytest.skip("XFOIL is not installed: apt-get install xfoil")


@pytest.fixture(scope="session")
def polar(xfoil, section):  # noqa: ARG001 - skipped without it
    return bw.polar(section, 3.5e6, [-2.0, 0.0, 4.0])
