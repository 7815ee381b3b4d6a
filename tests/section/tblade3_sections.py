"""What T-Blade3 computed for its sections, and the same sections as parts of the family."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bladewright.section.curvature_meanline import CurvatureMeanline
from bladewright.section.thickness.modified_naca import ModifiedNaca
from bladewright.section.thickness.quartic import QuarticSpline
from bladewright.section.thickness.wennerstrom import Wennerstrom

DATA = Path(__file__).parents[3] / "shared" / "data" / "tblade3"
CASES = {
    "Case7-28-8_Rotor": 21,
    "Case7-28-8_IGV": 21,
    "NACA_thickness_with_derivative": 21,
    "Wennerstrom_r37_v1.2.5": 21,
    "quartic_spline_thickness_rotor_v1.2.2": 5,
    "LE_spline_turb4_v1.2.2": 2,
}
"""number of sections by case"""


@dataclass(frozen=True, kw_only=True)
class Computed:
    """One section: the part, and what the program gave for it."""

    part: CurvatureMeanline
    stagger: float
    chord: float
    u: np.ndarray
    meanline: np.ndarray | None
    """(k, 3) v, v' and -v''"""
    upper: np.ndarray
    lower: np.ndarray
    shifted: np.ndarray
    """(2 k - 1, 2) around the section from the trailing edge over the upper side, moved to the stacking point"""
    placed: np.ndarray
    """(2 k - 1, 2) the same in (m', theta)"""


def need(case):
    if not (DATA / case).exists():
        pytest.skip(f"there is no {DATA / case}: the reference data is not beside the repository")


def table(case, pattern, **options):
    (found,) = (DATA / case).glob(pattern)
    return np.loadtxt(found, **options)


@cache
def computed(case, number):
    """The section of a number, counted from 1 at the hub."""
    need(case)
    (blade,) = (DATA / case / "output").glob(f"blade.{number}.*")
    head, *rows = blade.read_text().splitlines()[1:]
    tangents = [float(word) for word in head.split()]
    angles = dict(zip(("metal_angle_in", "metal_angle_out"), np.degrees(np.arctan(tangents[:2])), strict=True))
    mixed = case.startswith("Wennerstrom")
    meanline = None if mixed else table(case, f"output/curvature_data.{number}.*")
    return Computed(
        part=CurvatureMeanline(**angles, **_meanline(case, number), **_thickness(case, number)),
        stagger=np.ravel(table(case, "output/stagger_angles.dat"))[number - 1],
        chord=tangents[3],
        u=(table(case, f"output/thickness_data.{number}.*") if mixed else meanline)[:, 0],
        meanline=None if mixed else meanline[:, 1:],
        upper=table(case, f"output/topcurve.{number}.*"),
        lower=table(case, f"output/botcurve.{number}.*"),
        shifted=table(case, f"output/uvblade.{number}.*"),
        placed=np.array([[float(word) for word in row.split()] for row in rows if row.strip()]),
    )


def _meanline(case, number):
    if case.startswith("Wennerstrom"):
        return {"camber": "mixed"}
    if case.endswith("v1.2.2"):
        places, values = table(case, f"output/curvature_ctrl_pts.{number}.*", skiprows=3).T
    else:
        row = table(case, "output/curvature_span_variation*")[number - 1]
        places, values = np.split(row[:-1], 2)
    return {"curvature": tuple(values), "curvature_places": tuple(places[1:-1])}


def _thickness(case, number):
    if case.endswith("v1.2.2"):
        (file,) = (DATA / case / "input").glob("3dbgbinput*")
        rows = [line.split() for line in file.read_text().splitlines()]
        head = next(i for i, row in enumerate(rows) if row[:2] == ["J", "in_Beta"])
        at, leading, trailing = (float(word) for word in [row for row in rows if "sect1" in row][number - 1][4:7])
        places, values = table(case, f"output/thick_Multi_cp.{number}.*", skiprows=1)[2:-2].T
        law = QuarticSpline(
            maximum_thickness=float(rows[head + number][5]),
            maximum_thickness_at=at,
            leading_edge_thickness=leading,
            trailing_edge_thickness=trailing,
        )
        return {
            "thickness": law,
            "thickness_multiplier": tuple(values),
            "thickness_multiplier_places": tuple(places[1:-1]),
        }
    row = table(case, "output/thickness_span_variation*")[number - 1]
    if case.startswith("Wennerstrom"):
        edges = dict.fromkeys(["leading_edge_thickness", "trailing_edge_thickness"], 0.02)
        return {"thickness": Wennerstrom(maximum_thickness_at=row[0], maximum_thickness=row[1], **edges)}
    return {
        "thickness": ModifiedNaca(
            leading_edge_index=row[1],
            maximum_thickness_at=row[2],
            maximum_thickness=row[3],
            trailing_edge_thickness=row[4],
            trailing_edge_slope=row[5] if len(row) > 5 else None,
        )
    }
