"""Sections of the exact blade as curves in their plane."""

from types import MappingProxyType

import numpy as np

from bladewright.blade.exact import ExactBlade
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.section.curves import camber_curve, side_curve
from bladewright.section.section import Section


def section_at(exact: ExactBlade, v: float) -> Section:
    """The exact section at v in [0, 1]; raises DesignError outside."""
    if not 0.0 <= v <= 1.0:
        raise DesignError(f"a section was asked at v = {v:g}: v runs from 0 at the blade's hub end to 1 at its other")
    stations = exact.stations(np.array([v]))
    plane, lines = stations.plane, stations.lines

    def scale(abscissa: Array) -> Array:
        u = lines.u_at(np.atleast_1d(abscissa)[None])
        position = lines.position(u)
        speed = np.sqrt(np.sum(lines.position(u, 1) ** 2, axis=-1))
        return (speed / exact.mapping.density(position, lines.position(u, 1)))[0]

    ends = plane.camber[0, [0, 3]]
    return Section(
        span=v,
        plane=exact.mapping.plane,
        curves=MappingProxyType({"upper": side_curve(plane.upper[0]), "lower": side_curve(plane.lower[0])}),
        camber=camber_curve(plane.camber[0]),
        stagger=float(np.real(np.arctan((ends[1, 1] - ends[0, 1]) / (ends[1, 0] - ends[0, 0])))),
        metal_angle_in=float(np.real(stations.angle_in[0])),
        metal_angle_out=float(np.real(stations.angle_out[0])),
        scale=scale,
    )
