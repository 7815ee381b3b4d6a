"""Sweep and lean: sections shifted as they are, in their planes."""

from typing import TYPE_CHECKING

import numpy as np

from bladewright.blade.flow_path.blade_streamlines import OVERRUN, BladeStreamlines, blade_streamlines
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.numerics.elementary import Array
from bladewright.section.laws import Span

if TYPE_CHECKING:
    from bladewright.blade.design.sectioned import SectionedBlade


def shifts(design: "SectionedBlade", span: Span, stagger: Array) -> tuple[Array | None, Array | None, Array]:
    """How far the reference points of sections with a stagger (..., m) [rad] are moved, (..., m) each.

    Along the stream line [m], further along it as an increase of the abscissa, and around the axis, an arc at the
    radius after the shift [m], or along y in a cascade; None: not at all.
    """
    metre = design.metre
    sweep, lean, conformal = (
        None if law is None else span.values(law) for law in (design.sweep, design.lean, design.conformal_sweep)
    )
    none = np.zeros(len(span.v))
    along, across = (none if each is None else metre * each for each in (sweep, lean))
    if sweep is None and lean is None:
        return None, conformal, none
    if design.shift_directions == "meridional-tangential":
        return None if sweep is None else along, conformal, across
    turned = np.cos(stagger), np.sin(stagger)
    return along * turned[0] - across * turned[1], conformal, along * turned[1] + across * turned[0]


def shifted_lines(
    surfaces: StreamSurfaces,
    lines: BladeStreamlines,
    reference: Array,
    meridional: Array | None,
    conformal: Array | None,
) -> BladeStreamlines:
    """Stream lines by u between the edges of the shifted sections.

    `reference` (..., m) is the abscissa of the reference points from the leading edge. A section's extent in its plane
    stays. Raises DesignError where it would leave the flow path.
    """
    if meridional is None and conformal is None:
        return lines
    mapping, v = lines.mapping, lines.v
    ruler = _long_enough(surfaces, lines, meridional, conformal)
    moved = reference
    if meridional is not None:
        along = ruler.meridional(ruler.u_at(reference[..., None])) + meridional[..., None]
        moved = ruler.abscissa(ruler.u_at_length(along))[..., 0]
    if conformal is not None:
        moved = moved + conformal
    step = moved - reference
    leading, trailing = (ruler.t(ruler.u_at(place[..., None]))[..., 0] for place in (step, lines.extents() + step))
    return blade_streamlines(surfaces, v, mapping, leading, trailing)


def _long_enough(
    surfaces: StreamSurfaces, lines: BladeStreamlines, meridional: Array | None, conformal: Array | None
) -> BladeStreamlines:
    """The same stream lines, as far past the edges as the shifts may need."""
    shares = []
    if meridional is not None:
        shares.append(real_first(meridional / lines.lengths, 1))
    if conformal is not None:
        shares.append(real_first(conformal / lines.extents(), 1))
    # where the stream line widens, a length is more of u than its share
    far = OVERRUN + 3.0 * float(sum(np.sqrt(np.max(np.square(each))) for each in shares))
    return blade_streamlines(
        surfaces,
        lines.v,
        lines.mapping,
        lines.leading,
        lines.trailing,
        before=far,
        after=far,
    )
