"""Stand-ins until the native rooms have them."""
from dataclasses import dataclass
from collections.abc import Callable
from bladewright.nurbs.curve import Curve
from bladewright.nurbs import trimmed

@dataclass(frozen=True, kw_only=True)
class Revolution:
    meridian: Curve
    theta: Callable

@dataclass(frozen=True, kw_only=True, eq=False)
class TrimmedSurface(trimmed.TrimmedSurface):
    revolution: Revolution | None = None
