"""A polar that XFOIL made, kept in a file, for what is drawn and written without running it."""

from functools import cache
from pathlib import Path

import numpy as np

from bladewright.aerodynamics.airfoil import Airfoil
from bladewright.aerodynamics.conditions import Conditions
from bladewright.aerodynamics.polar import Polar
from bladewright.aerodynamics.xfoil_output import read_polar_dump

DUMP = Path(__file__).parents[1] / "aerodynamics" / "data" / "naca-23012.dump"
"""what Debian's XFOIL 6.99 wrote for NACA 23012 at Re 3.5e6, -2 and 4 deg, with 160 panels"""


@cache
def recorded_polar():
    """NACA 23012 at two angles, and a third that did not converge."""
    version, points = read_polar_dump(DUMP)
    rows = [(p.alpha, p.cl, p.cd, p.cdp, p.cm, *p.transition) for p in points] + [(30.0, *[np.nan] * 6)]
    alpha, cl, cd, cdp, cm, upper, lower = np.transpose(rows)
    flow = points[0].flow
    return Polar(
        airfoil=Airfoil(points=np.stack([flow.x, flow.y], axis=-1), name="naca-23012"),
        solver=f"XFOIL {version}",
        reynolds=3.5e6,
        reference_length=1.0,
        conditions=Conditions(reynolds=3.5e6),
        alpha=alpha,
        cl=cl,
        cd=cd,
        cdp=cdp,
        cm=cm,
        transition_upper=upper,
        transition_lower=lower,
        flows=(*(point.flow for point in points), None),
        failures=("alpha 30: XFOIL did not converge in 100 iterations, with 160 or 200 panels",),
    )
