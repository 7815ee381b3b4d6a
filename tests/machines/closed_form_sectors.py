"""The sector around the annular blade: what lies between hub and shroud, inlet and outlet where no blade stands."""

from dataclasses import dataclass

import numpy as np

from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import extended
from bladewright.nurbs.mass_properties import mass_properties
from bladewright.nurbs.revolution import Revolution
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

from .closed_forms import HUB, SHROUD, Blade, annular, doubled, fitted, meridian, side

INLET, OUTLET = 0.08, 0.92
"""where on the meridian curves the sector begins and ends"""
PITCH = 0.5
SHORT = np.array([0.0] * 6 + [1.0] * 6)


def camber(t: np.ndarray, v: np.ndarray) -> np.ndarray:
    """theta of a line through the blade, which turns on past its edges."""
    along = (t - 0.30 - 0.01 * v * v) / (0.36 + 0.04 * v)
    return (0.25 + 0.10 * v) * along + 0.05 * along * along - 0.15


def sector(*, name: str = "sector") -> Blade:
    """A sixth of an annulus, roughly, about the annular blade, its walls exact surfaces of revolution."""
    hub, shroud = meridian(HUB), meridian(SHROUD)
    along, knots_v = doubled(24, 5, at=(0.5,)), doubled(8, 5, at=(0.25, 0.5))

    def mapped(t: np.ndarray, theta: np.ndarray, v: np.ndarray) -> np.ndarray:
        t, theta, v = np.broadcast_arrays(t, theta, v)
        line = (1.0 - v)[..., None] * hub(t) + v[..., None] * shroud(t)
        return np.stack([line[..., 0], line[..., 1] * np.sin(theta), line[..., 1] * np.cos(theta)], axis=-1)

    def periodic(u: np.ndarray, v: np.ndarray, sign: int) -> np.ndarray:
        t = INLET + (OUTLET - INLET) * u
        return mapped(t, camber(t, v) + sign * PITCH / 2.0, v)

    def end(t: float) -> Surface:
        start = np.array(t)
        return side(lambda u, v, _: mapped(start, camber(start, v) + (u - 0.5) * PITCH, v), 0, SHORT, knots_v)

    upper, lower = (side(periodic, sign, along, knots_v) for sign in (1, -1))
    inlet, outlet = end(INLET), end(OUTLET)
    nets = {label: np.array(face.control_points) for label, face in (("inlet", inlet), ("outlet", outlet))}
    for label, row in (("inlet", 0), ("outlet", -1)):
        nets[label][0], nets[label][-1] = lower.control_points[row], upper.control_points[row]
    surfaces: dict[str, Surface | TrimmedSurface] = {"periodic_upper": upper, "periodic_lower": lower}
    for label, face in (("inlet", inlet), ("outlet", outlet)):
        surfaces[label] = Surface(
            control_points=nets[label], knots_u=face.knots_u, knots_v=face.knots_v, degree_u=5, degree_v=5
        )
    for label, line, v in (("hub", hub, 0.0), ("shroud", shroud, 1.0)):
        surfaces[label] = _wall(line, np.array(v))
    # e_x x e_r = -e_theta; along theta and then r the normal is e_theta x e_r = e_x; e_x x e_theta = e_r on the walls
    orientations = {"periodic_upper": -1, "periodic_lower": 1, "inlet": -1, "outlet": 1, "hub": -1, "shroud": 1}
    enclosed = mass_properties([(surfaces[label], sign) for label, sign in orientations.items()])
    return Blade(name=name, surfaces=surfaces, orientations=orientations, properties=enclosed)


def _wall(line: Curve, v: np.ndarray) -> TrimmedSurface:
    revolution = Revolution(meridian=line, start=-1.2, end=1.2)

    def traced(t: np.ndarray, share: np.ndarray) -> np.ndarray:
        t, share = np.broadcast_arrays(t, share)
        return np.stack([t, revolution.v(camber(t, v) + share * PITCH)], axis=-1)

    fine = doubled(48, 5, at=(0.5,))
    run = lambda u: INLET + (OUTLET - INLET) * u  # noqa: E731
    boundary = (
        fitted(lambda u: traced(run(u), np.array(-0.5)), fine),
        fitted(lambda u: traced(np.array(OUTLET), u - 0.5), fine),
        fitted(lambda u: traced(run(1.0 - u), np.array(0.5)), fine),
        fitted(lambda u: traced(np.array(INLET), 0.5 - u), fine),
    )
    return TrimmedSurface(surface=revolution.surface(), boundary=boundary, revolution=revolution)


def standing() -> Blade:
    """The annular blade with a third of its knots, which is cut in half the time."""
    return annular(spans=12)


def longer(span: float) -> Blade:
    """That blade continued past both walls by a part of its span, closed by ruled caps."""
    blade = standing()
    upper, lower = (extended(blade.surfaces[name], -span, 1.0 + span, "v") for name in ("upper", "lower"))
    surfaces: dict[str, Surface | TrimmedSurface] = {"upper": upper, "lower": lower}
    for label, edge in (("hub", 0), ("shroud", -1)):
        net = np.stack([lower.control_points[:, edge], upper.control_points[:, edge]], axis=1)
        surfaces[label] = Surface(
            control_points=net, knots_u=lower.knots_u, knots_v=[0, 0, 1, 1.0], degree_u=5, degree_v=1
        )
    orientations = {"upper": -1, "lower": 1, "hub": -1, "shroud": 1}
    enclosed = mass_properties([(surfaces[name], sign) for name, sign in orientations.items()])
    return Blade(name="extended", surfaces=surfaces, orientations=orientations, properties=enclosed)


@dataclass(frozen=True, kw_only=True)
class Extensible:
    def extended(self, span: float) -> Blade:
        return longer(span)


@dataclass(frozen=True, kw_only=True)
class Cuttable:
    periodic_sector: Blade
    blade: Extensible = Extensible()
    name: str = "passage"
