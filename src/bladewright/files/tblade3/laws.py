"""Laws along the span that take given values at the sections of a case, to rounding.

The sections stand where cubic splines through them have their knots at those of a law with as many control points: so
a law through all sections is the cubic spline through their values, without a third derivative's jump at the second and
the last but one, whatever their spans are. The span fraction of a design so made counts sections; it is not their
radius.
"""

import numpy as np

from bladewright.designs import ChordwiseLaw, Law
from bladewright.nurbs.basis import Reals
from bladewright.section.laws import DEGREE, law_basis

HELD = 1e-13
"""deviation of a law from its values, of the largest, that is rounding"""

ROUNDING = 1e-15
"""control points smaller than this, of the largest value, are 0"""


def section_places(spans: Reals, *further: Reals) -> Reals:
    """Span fractions (m,) of a design at which the sections with given spans (m,) stand, from 0 to 1.

    `further` are other measures (m,) of the same sections, such as their distances at another edge. The second and the
    last section but one stand as near to the ends as any measure has them: a cubic spline through sections that stand
    nearer to each other than their places say would swing, and their stream surfaces fold over.
    """
    count = len(spans)
    rising = bool(np.all(np.diff(spans) > 0.0))
    if count <= DEGREE + 1:
        return spans if rising else np.linspace(0.0, 1.0, count)
    knots = np.linspace(0.0, 1.0, count - DEGREE + 1)
    measures = [each for each in (spans, *further) if np.all(np.diff(each) > 0.0)]
    first = min([(each[1] - each[0]) / (each[2] - each[0]) for each in measures], default=0.5)
    last = min([(each[-1] - each[-2]) / (each[-1] - each[-3]) for each in measures], default=0.5)
    beside = first * knots[1], 1.0 - last * (1.0 - knots[-2])
    return np.concatenate([[0.0, beside[0]], knots[1:-1], [beside[1], 1.0]])


def law_through(values: Reals, places: Reals) -> Law:
    """The law with the fewest control points that has values (m,) at places (m,) to rounding: m at most."""
    scale = max(float(np.max(np.abs(values))), 1e-300)
    if np.ptp(values) <= HELD * scale:
        return float(values[len(values) // 2])
    for count in range(2, len(values)):
        rows = law_basis(count, places)
        controls: Reals = np.asarray(np.linalg.lstsq(rows, values, rcond=None)[0], dtype=np.float64)
        if np.max(np.abs(rows @ controls - values)) <= HELD * scale:
            return _plain(controls, scale)
    return _plain(np.asarray(np.linalg.solve(law_basis(len(values), places), values), dtype=np.float64), scale)


def _plain(controls: Reals, scale: float) -> Law:
    """Control points, rounding about 0 left out: it may have the sign that a number must not have."""
    return tuple(0.0 if abs(each) < ROUNDING * scale else float(each) for each in controls)


def laws_through(values: Reals, places: Reals) -> ChordwiseLaw:
    """The same of values (m, k): k laws, one a control point along the chord."""
    return tuple(law_through(column, places) for column in values.T)
