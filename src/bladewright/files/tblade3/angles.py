"""A T-Blade3 case's angles brought into the plane (m', theta) of its stream surfaces."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bladewright.files.tblade3.records import TBlade3Case
from bladewright.files.tblade3.sections import SectionValues
from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class MetalAngles:
    """Angles of the m sections [rad] in the plane (m', theta): of the meanline's ends, or what stands for them."""

    inlet: Reals | None
    """(m,) metal angle at the leading edge; None where the stagger is given"""
    exit: Reals | None
    """(m,) metal angle at the trailing edge; None where the stagger is given"""
    camber: Reals | None
    """(m,) total camber, exit less inlet; None where the file gives staggers in place of inlet angles"""
    stagger: Reals | None
    """(m,) stagger, of a wing and where the file gives it; else it follows from the meanline"""


def metal_angles(case: TBlade3Case, values: SectionValues, phi_in: ArrayLike, phi_out: ArrayLike) -> MetalAngles:
    """The sections' angles, given the slopes phi = atan(dr/dx) (m,) [rad] of their streamlines at both edges.

    beta_z, in a plane of constant radius, and beta_r, in one of constant x, belong to the same direction on the stream
    surface as beta: tan(beta) = tan(beta_z) cos(phi) = tan(beta_r) sin(phi). A wing's angles are taken as they are.
    """
    if values.stagger is not None:
        return MetalAngles(inlet=None, exit=None, camber=None, stagger=np.radians(values.stagger))
    if case.angles == "wing":
        camber, twist = np.radians(values.angle_out), np.radians(values.angle_in)
        return MetalAngles(inlet=None, exit=None, camber=camber, stagger=twist)
    inlet = on_stream_surface(values.angle_in, phi_in, radial=case.angles in {"radial", "radial-axial"})
    end = on_stream_surface(values.angle_out, phi_out, radial=case.angles in {"radial", "axial-radial"})
    return MetalAngles(inlet=inlet, exit=end, camber=end - inlet, stagger=None)


def on_stream_surface(angle: ArrayLike, phi: ArrayLike, *, radial: bool) -> Reals:
    """Angle [rad] in the plane (m', theta) of angles beta_z or, radial, beta_r [deg], at the slope phi [rad]."""
    part = np.sin(phi) if radial else np.cos(phi)
    found: Reals = np.arctan(np.tan(np.radians(angle)) * part)
    return found
