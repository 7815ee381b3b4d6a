"""Examples of every family that is one part: the members of the shared contract tests.

A family adds its examples to `EXAMPLES`; each is asked the same questions in `test_families.py`.
"""

from dataclasses import dataclass
from typing import Any

from bladewright.section.planar import PlanarSection

from .camber_angles import ANGLES, CAMBER_ANGLES, angle_section_of
from .meanlines import MEANLINES
from .oval import OVAL
from .profiles import PROFILES, PROPERTIES, section_of
from .segmented import AIRFOILS, BANDS, airfoil_of
from .suction_pressure import FAN_TIP, STATOR, TEARDROP, TURBINE, WEDGE, section, vane


@dataclass(frozen=True, kw_only=True)
class Example:
    """A 2D design, and what its section must have."""

    design: PlanarSection
    metal_angles: tuple[float, float] | None = None
    """[deg] of the built camber line at the leading and the trailing edge"""
    maximum_thickness: float | None = None
    """full thickness across the camber line, of the chord"""
    dead: tuple[str, ...] = ()
    """parameters that rightly have no effect on this example; say why beside it"""

    def part(self) -> Any:
        """The family's parameters."""
        return self.design.section


EXAMPLES: dict[str, Example] = {
    "oval": Example(design=OVAL, metal_angles=None, maximum_thickness=0.12),
    "suction and pressure side of a stator": Example(design=section(STATOR), metal_angles=(42.0, 2.0)),
    "suction side below and thickness of a fan tip": Example(design=section(FAN_TIP), metal_angles=(-64.0, -58.0)),
    "pseudo skeleton line of a turbine": Example(design=section(TURBINE), metal_angles=(44.0, -66.0)),
    "wedge diffuser with a back face": Example(design=vane(WEDGE), metal_angles=(65.0, 65.0)),
    "wedge diffuser of two circles": Example(design=vane(TEARDROP), metal_angles=(65.0, 65.0), maximum_thickness=0.16),
    **{name: Example(design=design, **having) for name, (design, having) in MEANLINES.items()},
    **{name: Example(design=angle_section_of(part), metal_angles=ANGLES[name]) for name, part in CAMBER_ANGLES.items()},
    # a band is checked, and moves nothing
    **{name: Example(design=airfoil_of(part), dead=BANDS.get(name, ())) for name, part in AIRFOILS.items()},
    **{name: Example(design=section_of(profile), **PROPERTIES.get(name, {})) for name, profile in PROFILES.items()},
}
"""By a name that says what is particular."""
