"""XFOIL's polar dump: the points that converged, with all digits (written by PACC, unformatted Fortran)."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from bladewright.aerodynamics.surface_flow import SurfaceFlow
from bladewright.errors import PolarError
from bladewright.frozen import FrozenRecord

PER_NODE = 6
"""numbers that a node has in the dump: x, cp, momentum and displacement thickness, cf, shear stress coefficient"""


@dataclass(frozen=True, kw_only=True, eq=False)
class ConvergedPoint(FrozenRecord):
    """An angle at which XFOIL converged; coefficients refer to the chord."""

    alpha: float
    """[deg]"""
    cl: float
    cd: float
    cm: float
    transition: tuple[float, float]
    """x/c of the upper and of the lower side"""
    flow: SurfaceFlow

    @property
    def cdp(self) -> float:
        """Drag by pressure: cd less the drag of the friction along the panels, as XFOIL has it."""
        return self.cd - self.flow.friction_drag


def read_polar_dump(path: Path) -> tuple[str, list[ConvergedPoint]]:
    """The version of XFOIL and the points of a dump in the order in which they converged; none of a missing file.

    XFOIL is compiled with numbers of four or of eight bytes, which the length of a record tells. A last point that was
    not written to its end, as the program was stopped, is left out. Raises PolarError where the file is something else.
    """
    if not path.exists():
        return "", []
    records = _records(path.read_bytes())
    try:
        header, conditions, _, counts, coordinates = islice(records, 5)
        real = np.dtype(f"<f{len(conditions) // 4}")
        version = float(np.frombuffer(header[-real.itemsize :], real)[0])
        nodes = np.frombuffer(coordinates, real).reshape(-1, 2).astype(np.float64)
        nodes = nodes.reshape(int(np.frombuffer(counts, "<i4")[-1]), 2)
    except (ValueError, TypeError) as error:
        raise PolarError(
            f"'{path.name}' of XFOIL is no polar dump of version 6.9: name another XFOIL by BLADEWRIGHT_XFOIL"
        ) from error
    points = []
    for figures, numbers, *sides in _grouped(records, 4):
        alpha, cl, cd, _, cm, *transition = (float(each) for each in np.frombuffer(figures, real))
        _, _, *ends = (int(each) for each in np.frombuffer(numbers, "<i4"))
        # from the stagnation point to the trailing edge; what follows is the wake
        upper, lower = (
            np.frombuffer(side, real).reshape(-1, PER_NODE)[1:end].astype(np.float64)
            for side, end in zip(sides, ends, strict=True)
        )
        around = np.concatenate([upper[::-1], lower])
        flow = SurfaceFlow(
            alpha=alpha, x=nodes[:, 0], y=nodes[:, 1], cp=around[:, 1], cf=around[:, 4], stagnation=len(upper)
        )
        points.append(
            ConvergedPoint(alpha=alpha, cl=cl, cd=cd, cm=cm, transition=(transition[0], transition[1]), flow=flow)
        )
    return f"{version:.4g}", points


def _records(data: bytes) -> Iterator[bytes]:
    """The records of an unformatted Fortran file, as far as they are whole."""
    place = 0
    while place + 8 <= len(data):
        (size,) = struct.unpack_from("<i", data, place)
        if size < 0 or place + 8 + size > len(data):
            return
        yield data[place + 4 : place + 4 + size]
        place += 8 + size


def _grouped(records: Iterator[bytes], count: int) -> Iterator[tuple[bytes, ...]]:
    """Records in groups of `count`; an unfinished last group is left out."""
    return zip(*[records] * count, strict=False)
