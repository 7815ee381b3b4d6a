"""Whether a match may be trusted, and why not."""

import numpy as np
from numpy.typing import NDArray

from bladewright.fitting.adaptation import Aim
from bladewright.fitting.estimates import Certainty
from bladewright.fitting.scatter import Scatter
from bladewright.fitting.search import Found
from bladewright.nurbs.basis import Reals

GROSS = 0.01
"""mean distance above which a match is none, of the chord"""
OFF = 0.1
"""part of the points that may be outliers"""
SHOWN = 5


def failures_of(
    distances: Reals, inliers: NDArray[np.bool_], regions: NDArray[np.str_], found: Found, aim: Aim
) -> tuple[str, ...]:
    """Why a match does not pass, each a sentence."""
    failures = []
    chord = found.model.chord
    kept = distances[inliers]
    if found.interrupted:
        failures.append("the search was interrupted: this is the best design so far")
    if len(kept) < (1.0 - OFF) * len(distances):
        failures.append(
            f"{len(distances) - len(kept)} of {len(distances)} points lie off the blade: is it one blade, and of this "
            "family?"
        )
    worst = int(np.flatnonzero(inliers)[np.argmax(kept)])
    if aim.tolerance is not None and kept.max() > aim.tolerance:
        failures.append(
            f"the largest deviation is {1e3 * kept.max():.4g} mm ({regions[worst]}, point {worst}), and "
            f"{1e3 * aim.tolerance:.4g} mm were asked for"
        )
    if np.mean(kept) > GROSS * chord:
        failures.append(
            f"the mean deviation is {1e3 * np.mean(kept):.4g} mm, {100 * np.mean(kept) / chord:.2g} % of the chord: no "
            "design of this family was found near the points"
        )
    return tuple(failures)


def notes_of(notes: tuple[str, ...], found: Found, certainty: Certainty, scatter: Scatter) -> tuple[str, ...]:
    """What else there is to know, each a sentence."""
    said = list(notes)
    unknown = [each.path for each in certainty.estimates if not each.identified]
    if unknown:
        more = f" and {len(unknown) - SHOWN} more" if len(unknown) > SHOWN else ""
        said.append(f"the cloud does not determine {', '.join(unknown[:SHOWN])}{more}")
    bound = [each.path for each in certainty.estimates if each.at_bound]
    if bound:
        said.append(f"on a bound: {', '.join(bound[:SHOWN])}{'...' if len(bound) > SHOWN else ''}")
    del found, scatter
    return tuple(said)
