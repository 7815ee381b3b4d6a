"""Limits of the parameters that every design of the unified family has."""

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.section import checks

ANGLES = ("stagger", "metal_angle_in", "metal_angle_out")
TANGENTS = ("tangent_in", "tangent_out")
RADII = ("leading_edge_radius", "trailing_edge_radius")
THICKNESSES = ("thickness_upper", "thickness_lower")
WEIGHTS = ("weights_upper", "weights_lower")


def check_labels(design: Design) -> None:
    """Name, header texts and unit of length."""
    for label in ("name", "description", "author", "organisation"):
        checks.text(label, getattr(design, label))
    name = getattr(design, "name")  # noqa: B009 - a field of every family, not of the base
    if not name.strip() or any(sign in name for sign in '/\\:*?"<>|'):
        raise DesignError(f'name is {name!r}: it names files, so it must not be empty nor hold / \\ : * ? " < > |')
    checks.choice("length_unit", getattr(design, "length_unit"), list(checks.UNITS))  # noqa: B009 - as above


def check_laws(design: Design) -> None:
    """Angles, tangent proportions, edge radii, thicknesses and weights; brings them to tuples of numbers."""
    for name in (*ANGLES, *TANGENTS, *RADII):
        object.__setattr__(design, name, checks.law(name, getattr(design, name)))
    for name in (*THICKNESSES, *WEIGHTS):
        if name in THICKNESSES or getattr(design, name) != ():
            object.__setattr__(design, name, checks.chordwise(name, getattr(design, name)))
    for name in ANGLES:
        checks.between(name, getattr(design, name), -90.0, 90.0, "an angle must lie between -90 and 90 deg")
    for name in TANGENTS:
        what = "a tangent proportion must lie above 0 and not above 1, or the camber turns back"
        checks.between(name, getattr(design, name), 0.0, 1.0 + 1e-12, what)
    for name in RADII:
        checks.between(name, getattr(design, name), 0.0, 1.0, "an edge radius must lie between 0 and 1")
    for name in THICKNESSES:
        checks.between(name, getattr(design, name), 0.0, 10.0, "thickness must be positive, and below 10; raise it")
    for name in WEIGHTS:
        checks.between(name, getattr(design, name), 0.0, 1e6, "a weight must be positive, and below 1e6")


def check_sampling(design: Design) -> None:
    """Number and clustering of the samples along the chord."""
    samples = getattr(design, "samples")  # noqa: B009 - a field of every family, not of the base
    object.__setattr__(design, "samples", checks.integer("samples", samples, 3, 60, "a whole number is needed"))
    check_range(design, "clustering", 0.0, 1.0)


def check_range(design: Design, name: str, low: float, high: float) -> None:
    """A number from low to high."""
    object.__setattr__(design, name, checks.number(name, getattr(design, name)))
    checks.between(name, getattr(design, name), low, high, f"it must lie from {low:g} to {high:g}", closed=True)
