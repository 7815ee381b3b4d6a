"""Sections that the family holds nearly, as their edges are sharper: published profiles, written with few digits."""

import numpy as np

from bladewright.files.clouds import read_cloud
from bladewright.fitting.fit import fit
from bladewright.section.profiles.c4 import C4
from bladewright.section.profiles.kinds import ProfileSection

CHORD = 1.0
DIGITS = 5
"""that published tables of profiles have"""


def table(path, count, *, lednicer=False):
    """A file of `count` points on each side of a C4 profile of 30 deg camber, denser at the edges."""
    built = ProfileSection(
        name="c4", length_unit="m", chord=CHORD, section=C4(thickness=0.1, camber_angle=30.0)
    ).build()
    t = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, count))) / 2.0
    sides = []
    for curve in built.curves.values():
        u = np.linspace(0.0, 1.0, 2001)
        way = np.concatenate([[0.0], np.cumsum(np.sqrt(np.sum(np.diff(curve(u), axis=0) ** 2, axis=1)))])
        sides.append(curve(np.interp(t, way / way[-1], u)))
    upper, lower = sides[:2]
    blocks = [[[count, count]], upper, lower] if lednicer else [upper[::-1], lower[1:]]
    rows = [f"{x:.{DIGITS}f} {y:.{DIGITS}f}" for block in blocks for x, y in block]
    path.write_text("C4\n" + "\n".join(rows) + "\n")
    return path


def test_a_published_profile_of_thirty_points_a_side_is_matched_and_passes(tmp_path):
    selig, lednicer = (
        read_cloud(table(tmp_path / f"{order}.dat", 31, lednicer=order == "lednicer"))
        for order in ("selig", "lednicer")
    )
    assert (selig.format, lednicer.format) == ("a Selig airfoil", "a Lednicer airfoil")
    # the two hold the same points, but for the leading edge, which one of them has twice
    assert set(map(tuple, selig.points)) == set(map(tuple, lednicer.points))
    found = fit(selig.points)
    assert found.passed
    # a fiftieth of a millimetre on a chord of 40 mm
    assert found.deviation.maximum < 5e-4 * CHORD
