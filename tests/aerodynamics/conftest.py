"""NACA 23012 by points, and XFOIL where it is installed."""

import shutil
from pathlib import Path

import pytest

import bladewright as bw

DUMP = Path(__file__).parent / "data" / "naca-23012.dump"
"""what XFOIL 6.99 of Debian wrote for NACA 23012 at Re 3.5e6, -2 and 4 deg, with 160 panels"""
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
