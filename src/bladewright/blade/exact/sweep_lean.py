"""Sweep and lean: sections shifted as they are, in their planes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.flow_path.blade_streamlines import BESIDE, BladeStreamlines, blade_streamlines
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import DiscreteConformal
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.numerics.elementary import Array
from bladewright.section.checks import UNITS
from bladewright.section.laws import Span

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade


@dataclass(frozen=True, kw_only=True, eq=False)
class Shift:
    """How far the reference points (..., m) of sections are moved."""

    meridional: Array | None
    """along the stream line [m]; None: not at all"""
    conformal: Array | None
    """further along it, by this much of the abscissa; None: not at all"""
    tangential: Array
    """around the axis, an arc at the radius after the shift [m]; in a cascade y [m]"""


def shift_of(design: "SectionedBlade", span: Span, stagger: Array) -> Shift:
    """The shifts that a design asks for at a span's places, of sections that stand at a stagger (..., m) [rad]."""
    metre = UNITS[design.length_unit]
    sweep, lean, conformal = (
        None if law is None else span.values(law) for law in (design.sweep, design.lean, design.conformal_sweep)
    )
    none = np.zeros(len(span.v))
    along, across = (none if each is None else metre * each for each in (sweep, lean))
    if sweep is None and lean is None:
        return Shift(meridional=None, conformal=conformal, tangential=none)
    if design.shift_directions == "meridional-tangential":
        return Shift(meridional=None if sweep is None else along, conformal=conformal, tangential=across)
    turned = np.cos(stagger), np.sin(stagger)
    return Shift(
        meridional=along * turned[0] - across * turned[1],
        conformal=conformal,
        tangential=along * turned[1] + across * turned[0],
    )


def shifted_lines(
    surfaces: StreamSurfaces, lines: BladeStreamlines, reference: Array, shift: Shift
) -> BladeStreamlines:
    """Stream lines by u between the edges of the shifted sections.

    `reference` (..., m) is the abscissa of the reference points from the leading edge. A section's extent in its plane
    stays. Raises DesignError where it would leave the flow path.
    """
    if shift.meridional is None and shift.conformal is None:
        return lines
    mapping, v = lines.mapping, lines.v
    ruler = _long_enough(surfaces, lines, shift)
    moved = reference
    if shift.meridional is not None:
        along = ruler.meridional(ruler.u_at(reference[..., None])) + shift.meridional[..., None]
        moved = ruler.abscissa(ruler.u_at_length(along))[..., 0]
    if shift.conformal is not None:
        moved = moved + shift.conformal
    step = moved - reference
    leading, trailing = (ruler.t(ruler.u_at(place[..., None]))[..., 0] for place in (step, lines.extents() + step))
    return blade_streamlines(surfaces, v, mapping, leading, trailing, counted=isinstance(mapping, DiscreteConformal))


def _long_enough(surfaces: StreamSurfaces, lines: BladeStreamlines, shift: Shift) -> BladeStreamlines:
    """The same stream lines, laid out as far as the shifts may need."""
    shares = []
    if shift.meridional is not None:
        shares.append(real_first(shift.meridional / lines.lengths, 1))
    if shift.conformal is not None:
        shares.append(real_first(shift.conformal / lines.extents(), 1))
    # where the stream line widens, a length is more of u than its share
    far = BESIDE + 3.0 * float(sum(np.sqrt(np.max(np.square(each))) for each in shares))
    return blade_streamlines(
        surfaces,
        lines.v,
        lines.mapping,
        lines.leading,
        lines.trailing,
        counted=isinstance(lines.mapping, DiscreteConformal),
        before=far,
        after=far,
    )
