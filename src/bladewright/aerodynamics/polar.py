"""A polar: lift, drag and moment of a lone airfoil over the angle of attack."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from bladewright.aerodynamics.airfoil import Airfoil, airfoil_of
from bladewright.aerodynamics.conditions import Conditions
from bladewright.aerodynamics.neuralfoil import neuralfoil_columns
from bladewright.aerodynamics.surface_flow import Segments, SurfaceFlow
from bladewright.aerodynamics.xfoil import xfoil_points
from bladewright.atomic_write import atomic_write
from bladewright.display import Shown
from bladewright.errors import PolarError
from bladewright.frozen import FrozenRecord
from bladewright.numerics.elementary import frozen
from bladewright.nurbs.basis import Reals
from bladewright.section.section import Section

Solver = Literal["xfoil", "neuralfoil"]
"""The programs that make polars."""
COLUMNS = ("alpha", "cl", "cd", "cdp", "cm", "transition_upper", "transition_lower")
"""The columns of a polar, in the order of tables."""
ANGLES = 90.0
"""deg; angles of attack lie between -90 and 90"""
APART = 1e-3
"""deg; angles of a polar differ by more"""
MOST = 1000
"""angles of one polar"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Polar(FrozenRecord, Shown):
    """Coefficients of a lone airfoil, (n,) each, at n angles of attack; NaN where the solver did not converge."""

    shown_as: ClassVar[str] = "polar"

    airfoil: Airfoil
    solver: str
    """name and version of the program"""
    reynolds: float
    """by the reference length"""
    reference_length: float
    """length by which Reynolds number and coefficients are made; the chord, if not given [m]"""
    conditions: Conditions
    """the same by the chord, as the solver has them"""
    alpha: Reals
    """angle of attack, from the chord line [deg]"""
    cl: Reals
    """lift"""
    cd: Reals
    """drag"""
    cdp: Reals
    """drag by pressure, which is cd less the friction's; NaN where the solver has none"""
    cm: Reals
    """moment about the moment point, nose up"""
    transition_upper: Reals
    """x/c of transition on the upper side"""
    transition_lower: Reals
    """x/c of transition on the lower side"""
    flows: tuple[SurfaceFlow | None, ...]
    """cp and cf around the airfoil at each angle; None where the solver gives none"""
    failures: tuple[str, ...] = ()
    """a sentence for each angle that did not converge"""
    remarks: tuple[str, ...] = ()
    """what the reader must know: a cascade's section, an edge cut off, a solver's accuracy"""

    def __post_init__(self) -> None:
        for name in COLUMNS:
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def name(self) -> str:
        """That of the airfoil."""
        return self.airfoil.name

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(n,) whether the solver converged."""
        return np.isfinite(self.cl)

    @property
    def lift_to_drag(self) -> Reals:
        """(n,) cl / cd."""
        return self.cl / self.cd

    def flow(self, alpha: float) -> SurfaceFlow:
        """cp and cf around the airfoil at an angle of the polar [deg]; raises PolarError where there are none."""
        index = int(np.argmin(np.abs(self.alpha - alpha)))  # real: angles of a real solver
        found = self.flows[index]
        if abs(self.alpha[index] - alpha) >= APART:  # real: angles of a real solver
            raise PolarError(f"alpha is {alpha:g} deg, which is none of the polar's {len(self.alpha)} angles")
        if found is None:
            why = "did not converge there" if not self.converged[index] else "gives no cp and cf; take solver='xfoil'"
            raise PolarError(f"alpha is {alpha:g} deg: {self.solver} {why}")
        return found

    def segments(self, alpha: float, cuts: Sequence[float] | None = None) -> Segments:
        """Lift and drag of each part of the outline between two cuts x/c and the nose, at an angle of the polar [deg].

        Where no cuts are given they are those of a segmented airfoil, or 0.3 and 0.7. Figures are by the reference
        length. Raises PolarError where there is no cp, or where cuts are out of order.
        """
        share = self.airfoil.chord / self.reference_length
        return self.flow(alpha).segments(self.airfoil.nose, cuts or self.airfoil.cuts).scaled(share)

    def to_dict(self) -> dict[str, object]:
        """Conditions and columns, for JSON."""
        return {
            "name": self.name,
            "solver": self.solver,
            "reynolds": self.reynolds,
            "mach": self.conditions.mach,
            "n_crit": self.conditions.n_crit,
            "forced_transition": list(self.conditions.transition),
            "moment_point": self.conditions.moment_point,
            "reference_length": self.reference_length,
            "chord": self.airfoil.chord,
            **{name: getattr(self, name).tolist() for name in COLUMNS},
            "failures": list(self.failures),
            "remarks": list(self.remarks),
        }

    def to_csv(self, path: str | Path) -> None:
        """Write the columns, one angle a line; an angle that did not converge has empty cells."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in zip(*(getattr(self, name) for name in COLUMNS), strict=True):
            writer.writerow("" if np.isnan(value) else repr(float(value)) for value in row)
        with atomic_write(path) as unfinished:
            Path(unfinished).write_text(text.getvalue(), encoding="utf-8")

    def __str__(self) -> str:
        by = "" if self.reference_length == self.airfoil.chord else f" by {self.reference_length:g} m"
        head = (
            f"{self.name}: {self.solver}, Reynolds number {self.reynolds:g}{by}, Mach number {self.conditions.mach:g}"
        )
        digits = (".4g", ".4f", ".5f", ".5f", ".4f", ".4f", ".4f")
        rows = [tuple(name.replace("_", " ") for name in COLUMNS)]
        rows += [
            tuple("-" if np.isnan(value) else f"{value:{digit}}" for value, digit in zip(row, digits, strict=True))
            for row in zip(*(getattr(self, name) for name in COLUMNS), strict=True)
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)) for row in rows)
        return "\n".join([head, *lines, *self.failures, *(f"note: {remark}" for remark in self.remarks)])


def polar(
    airfoil: Section | Airfoil,
    reynolds: float,
    alpha: float | Sequence[float] | Reals,
    *,
    mach: float = 0.0,
    solver: Solver = "xfoil",
    n_crit: float = 9.0,
    transition: tuple[float, float] = (1.0, 1.0),
    reference_length: float | None = None,
    moment_point: float = 0.25,
    panels: int = 160,
    iterations: int = 100,
    time_limit: float = 60.0,
) -> Polar:
    """The polar of a section of any family, or of an `Airfoil` by points, at angles of attack alpha [deg].

    `reynolds` is by the chord, or by `reference_length` [m], which then makes the coefficients too. `n_crit` is the
    exponent of the e^n method, `transition` the x/c at which transition is forced on upper and lower side, and
    `moment_point` the x/c of the moment. XFOIL runs in a process and a scratch folder of its own, so that polars may be
    made side by side; after `time_limit` [s] it is stopped, and what it had done by then is kept. Raises PolarError
    where something is asked for wrongly, or where the solver is missing or gives nothing at all.

    >>> import bladewright as bw
    >>> section = bw.read_design("naca-23012.toml").build()  # doctest: +SKIP
    >>> bw.polar(section, 3.5e6, [0.0, 4.0]).lift_to_drag  # doctest: +SKIP
    """
    if not isinstance(airfoil, Airfoil | Section):
        raise PolarError(
            f"a polar is asked of {type(airfoil).__name__}: give a section, such as design.build() of a 2D design or "
            "blade.section(0.5), or Airfoil(points=...)"
        )
    subject = airfoil if isinstance(airfoil, Airfoil) else airfoil_of(airfoil)
    length = subject.chord if reference_length is None else reference_length
    if not 0.0 < length < np.inf:
        raise PolarError(f"reference_length is {length:g} m: it must be positive")
    angles = _angles(alpha)
    share = subject.chord / length
    conditions = Conditions(
        reynolds=reynolds * share,
        mach=mach,
        n_crit=n_crit,
        transition=transition,
        moment_point=moment_point,
        panels=panels,
        iterations=iterations,
        time_limit=time_limit,
    )
    if solver == "xfoil":
        name, points, failures, panelled = xfoil_points(subject, angles, conditions)
        rows = [NONE if p is None else (p.cl, p.cd, p.cdp, p.cm, *p.transition) for p in points]
        columns = dict(zip(COLUMNS[1:], np.transpose(rows), strict=True))
        flows = tuple(None if point is None else point.flow for point in points)
        remarks = (*subject.remarks, *panelled)
    elif solver == "neuralfoil":
        name, columns, accuracy = neuralfoil_columns(subject, angles, conditions)
        flows, failures, remarks = (None,) * len(angles), [], (*subject.remarks, accuracy)
    else:
        raise PolarError(f"solver is '{solver}': it must be 'xfoil' or 'neuralfoil'")
    powers = {"cl": 1, "cd": 1, "cdp": 1, "cm": 2}
    return Polar(
        airfoil=subject,
        solver=name,
        reynolds=reynolds,
        reference_length=length,
        conditions=conditions,
        alpha=np.array(angles),
        flows=flows,
        failures=tuple(failures),
        remarks=remarks,
        **{column: values * share ** powers.get(column, 0) for column, values in columns.items()},
    )


NONE = (np.nan,) * (len(COLUMNS) - 1)
"""The columns where the solver did not converge."""


def _angles(alpha: float | Sequence[float] | Reals) -> list[float]:
    """The angles [deg] as a list; raises PolarError where they cannot be a polar's."""
    try:
        angles = np.atleast_1d(np.asarray(alpha, dtype=np.float64)).ravel()
    except (TypeError, ValueError):
        angles = np.array([np.nan])
    if not 0 < len(angles) <= MOST or not np.all(np.abs(angles) <= ANGLES):  # real: angles of a real solver
        given = f" from {np.min(angles):g} to {np.max(angles):g} deg" if len(angles) else ""
        raise PolarError(
            f"alpha has {len(angles)} angles{given}: give 1 to {MOST} numbers between -{ANGLES:g} and {ANGLES:g} deg"
        )
    close = np.diff(np.sort(angles))
    if np.any(close < APART):
        raise PolarError(
            f"alpha has angles {np.min(close):.2g} deg apart: give each once, at least {APART:g} deg apart"
        )
    return [float(each) for each in angles]
