"""NeuralFoil (Sharpe 2024): a neural network trained on XFOIL's results, a thousand times as fast."""

import importlib.util
from collections.abc import Sequence
from functools import cache
from importlib import metadata

import numpy as np

from bladewright.aerodynamics.airfoil import Airfoil
from bladewright.aerodynamics.conditions import Conditions
from bladewright.errors import PolarError
from bladewright.nurbs.basis import Reals

MODEL = "xlarge"
"""the size of network that NeuralFoil recommends"""
ACCURACY = (
    "NeuralFoil is a neural network trained on XFOIL: on common airfoils at Re 5e5 and more its cl was within 0.02 and "
    "its cd within 5 % of XFOIL's, at Re 1e5 near stall 0.3 and 42 % off; it gives neither cdp, cp nor cf; confirm "
    "what matters with XFOIL"
)
"""What every polar by NeuralFoil says; measured on NACA 0018, 4412 and 23012 (design/polar_solvers.py)."""
QUARTER = 0.25
"""x/c about which NeuralFoil gives the moment"""
MISSING = "NeuralFoil is not installed: install it with pip install 'bladewright[polar]', or take solver='xfoil'"
"""The message where it is not installed."""


def neuralfoil_columns(
    airfoil: Airfoil, angles: Sequence[float], conditions: Conditions
) -> tuple[str, dict[str, Reals], str]:
    """The solver's name, columns (n,) of the angles [deg] as `Polar` has them, and what the reader must know.

    Raises PolarError where NeuralFoil is not installed, or is asked for a compressible flow, which it does not know.
    """
    if conditions.mach > 0.0:
        raise PolarError(f"mach is {conditions.mach:g}: NeuralFoil knows incompressible flow only; take solver='xfoil'")
    if importlib.util.find_spec("neuralfoil") is None:
        raise PolarError(MISSING)
    import neuralfoil

    # a morphed airfoil is off its chord line: the network knows airfoils along the line from their farthest point
    x, y = airfoil.points.T
    outline = x + 1j * y
    end = (outline[0] + outline[-1]) / 2.0
    start = outline[np.argmax(np.hypot(x - end.real, y - end.imag))]
    chord, turn = np.hypot((end - start).real, (end - start).imag), np.angle(end - start)
    level = (outline - start) / (end - start)
    alpha = np.asarray(angles)
    found = neuralfoil.get_aero_from_coordinates(
        np.stack([level.real, level.imag], axis=-1),
        alpha=alpha - np.degrees(turn),
        Re=conditions.reynolds * chord,
        n_crit=conditions.n_crit,
        xtr_upper=conditions.transition[0],
        xtr_lower=conditions.transition[1],
        model_size=MODEL,
    )
    cl, cd, cm, upper, lower, confidence = (
        np.broadcast_to(np.asarray(found[name], dtype=np.float64), alpha.shape)
        for name in ("CL", "CD", "CM", "Top_Xtr", "Bot_Xtr", "analysis_confidence")
    )
    force = chord * (cd + 1j * cl) * np.exp(1j * np.radians(alpha))
    arm = start + QUARTER * (end - start) - conditions.moment_point
    nose_up = arm.imag * force.real - arm.real * force.imag
    return (
        f"NeuralFoil {_version()} {MODEL}",
        {
            "cl": chord * cl,
            "cd": chord * cd,
            "cdp": np.full(alpha.shape, np.nan),
            "cm": chord**2 * cm + nose_up,
            "transition_upper": upper,
            "transition_lower": lower,
        },
        f"{ACCURACY}; its own confidence in these figures is {np.min(confidence):.2f} or more, of 1",
    )


@cache
def _version() -> str:
    # reading it takes a fifth of the time of a polar
    return metadata.version("neuralfoil")
