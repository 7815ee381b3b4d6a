"""Stream lines between the edges of sections whose chord and reference point are given."""

import numpy as np

from bladewright.blade.bladed_lines import BladedLines, bladed_lines
from bladewright.blade.mapping import Mapping, TrueLengths
from bladewright.blade.meridian_line import real_first
from bladewright.blade.planes import Counted
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, length
from bladewright.numerics.roots import bracketed_root
from bladewright.nurbs.basis import Reals

REACH = 4.0
"""chords around the reference point within which the edges are looked for"""
ROUNDING = 1e-12
"""share of the room in the flow path that is left to rounding"""


def lines_of_chord(
    surfaces: StreamSurfaces, v: Reals, mapping: Mapping, t: Array, share: Array, extent: Array
) -> BladedLines:
    """Stream lines at v (m,) by u between the edges of sections whose reference points stand at t (..., m).

    `share` (..., m) of the sections' extent along the abscissa lies upstream of that point, and `extent` (..., m) [m]
    is that extent: in length along the stream line, or the abscissa's own in planes of true lengths. Raises DesignError
    where an edge would lie past the flow path.
    """
    at, asked, own = (real_first(each, 1) for each in (t, extent, share))
    unit = asked / length(real_first(surfaces.position(v, at[:, None], 1), 3)[:, 0])
    counted = isinstance(mapping, Counted)
    ruler = bladed_lines(surfaces, v, mapping, t, t + unit, counted=counted, before=REACH, after=REACH)
    real = ruler.real()
    low, high = real.reach()
    with np.errstate(divide="ignore"):
        most = np.minimum(-low / np.maximum(own, 0.0), high / np.maximum(1.0 - own, 0.0)) * (1.0 - ROUNDING)
    if isinstance(mapping, TrueLengths):
        _check(v, asked, most, at, surfaces)
        found = extent
    else:
        _check(v, asked, _length(real, own, most)[0], at, surfaces)
        found = bracketed_root(lambda part: _less(_length(real, own, part), asked), np.zeros(len(v)), most)
        if np.iscomplexobj(ruler.leading) or np.iscomplexobj(share) or np.iscomplexobj(extent):
            value, slope = _less(_length(ruler, share, found), extent)
            found = found - 1j * np.imag(value) / real_first(slope, 1)
    ends = -share * found, found - share * found
    leading, trailing = (ruler.t(ruler.u_at(place[..., None]))[..., 0] for place in ends)
    return bladed_lines(surfaces, v, mapping, leading, trailing, counted=counted)


def _length(ruler: BladedLines, share: Array, extent: Array) -> tuple[Array, Array]:
    """Length (..., m) along the stream line between edges `extent` apart in the plane, and its derivative by that."""
    total: Array = np.zeros(())
    slope: Array = np.zeros(())
    for part in (1.0 - share, share):
        place = part * extent if part is not share else -share * extent
        u = ruler.u_at(place[..., None])
        along = ruler.meridional(u)[..., 0]
        total = total + (along if part is not share else -along)
        slope = slope + part * (length(ruler.position(u, 1)) / ruler.densities(u)[0])[..., 0]
    return total, slope


def _less(found: tuple[Array, Array], asked: Array) -> tuple[Array, Array]:
    return found[0] - asked, found[1]


def _check(v: Reals, extent: Reals, longest: Reals, at: Reals, surfaces: StreamSurfaces) -> None:
    over = extent - longest
    if np.max(over) <= 0.0:
        return
    i = int(np.argmax(over / extent))
    x, r = real_first(surfaces.position(v[[i]], at[[i], None]), 3)[0, 0]
    raise DesignError(
        f"stacking.chord: at v = {v[i]:.4g} the section is {extent[i]:.5g} m long along the flow, and about its "
        f"reference point at (x, r) = ({x:.5g}, {r:.5g}) m there is room for {longest[i]:.5g} m in the flow path: "
        "shorten the chord, lengthen hub and shroud, or move the reference point"
    )
