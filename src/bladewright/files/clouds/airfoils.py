"""Airfoil files: a title, then x y around the profile (Selig) or x y of each side from the leading edge (Lednicer)."""

import numpy as np

from bladewright.nurbs.basis import Reals


def parted(values: Reals, title: str) -> tuple[str, int]:
    """What two columns (n, 2) below a title are, in words, and the row in which their points begin.

    A Lednicer file has the numbers of points of its two sides above them.
    """
    first = values[0]
    counted = bool(np.all(first == np.round(first)) and np.min(first) > 1.0 and first.sum() == len(values) - 1)
    if counted:
        return "a Lednicer airfoil", 1
    around = np.argmin(values[:, 0]) not in (0, len(values) - 1) and np.max(np.abs(values)) <= 2.0
    return ("a Selig airfoil" if title and around else "a table"), 0
