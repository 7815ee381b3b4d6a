"""NACA 65-series compressor profiles (Herrig, Emery and Erwin 1951, NACA RM L51G31)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bladewright.designs import Law, Limits, parameter
from bladewright.section.laws import Span
from bladewright.section.outline import Outline
from bladewright.section.profiles.mean_line import ChebyshevForm, MeanLineOutline
from bladewright.section.profiles.naca6 import STRETCHING, LoadedLine, clustering
from bladewright.section.profiles.profile import PublishedProfile

FORM = (
    1.051996, -0.194128, -0.293876, -0.098881, 0.018331, -0.007324, 0.021048, 0.003168, 0.024784, 0.004531, 0.012099,
    0.002064, 0.005601,
)  # fmt: skip
"""half thickness over the thickness: Chebyshev coefficients by degree; see design/six_series.py"""
END_THICKNESS = 0.03
"""thickness of the trailing edge of compressor blades, 2 x 0.15 % of the chord at a thickness of 10 %, of the maximum
thickness (NACA RM L51G31, 1951) [-]"""

LIFT = Limits(-3.0, 3.0, "a lift coefficient must lie between -3 and 3")


@dataclass(frozen=True, kw_only=True)
class Naca65(PublishedProfile):
    """A NACA 65-series compressor profile: 65-(12)10 has lift coefficient 1.2 and thickness 0.10.

    The form 65-010, scaled to the thickness, is laid off the mean line of uniform load (a = 1), which is rounded over
    0.005 chords at the edges, where its slope would be infinite. The form is a polynomial of degree 12 times
    sqrt(x) (1 - x) that meets the published ordinates within 9e-5 chords at a thickness of 0.1.
    """

    kind: Literal["naca-65-compressor"] = "naca-65-compressor"
    """which kind of profile this is"""
    lift_coefficient: Law = parameter("-", limits=LIFT, default=0.0)
    """of the isolated profile's mean line, the number in brackets over ten [-]"""

    def outline(self, span: Span) -> Outline:
        """The exact sections (..., m) at the places of the span, in chords, unstaggered."""
        thickness = span.values(self.thickness)[..., None]
        lift = span.values(self.lift_coefficient)[..., None]
        return MeanLineOutline(
            mean_line=LoadedLine(lift=lift, load=np.ones((1, 1))),
            thickness=ChebyshevForm(
                coefficients=[thickness * each for each in FORM],
                end=0.5 * thickness * self.trailing_edge_share(span, END_THICKNESS),
                opening=self.trailing_edge_opening,
            ),
            end=self.trailing_edge,
            clustering=clustering(self.trailing_edge),
            stretching=STRETCHING,
        )
