"""Stream lines between the edges of sections whose chord and reference point are given."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bladewright.blade.flow_path.blade_streamlines import BladeStreamlines, blade_streamlines
from bladewright.blade.flow_path.meridional_curve import real_first
from bladewright.blade.flow_path.stream_surface_map import StreamSurfaceMap
from bladewright.blade.flow_path.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array, concatenated, length
from bladewright.nurbs.basis import Reals

REACH = 4.0
"""Chords around the reference point within which the edges are looked for, where the flow path reaches so far:
chords are measured along stream lines that may widen."""
ROUNDING = 1e-12
"""Share of the flow path's room that is left for rounding."""
STEPS = 40
"""Newton steps; mostly five suffice."""
CONVERGED = 1e-8
"""Relative Newton step at which the iteration ends: the error left is its square, which is rounding."""
_START = np.zeros(1)


@dataclass(frozen=True, kw_only=True, eq=False)
class ChordPlacement:
    """Stream lines at v (m,) around reference points, on which the edges of sections of given chords are found."""

    lines: BladeStreamlines
    """u is 0 at the reference points, and 1 about a chord downstream"""
    surfaces: StreamSurfaces
    at: Reals
    """(m,) t of the reference points in the flow path"""

    def between(self, share: Array, extent: Array) -> BladeStreamlines:
        """Stream lines by u between the edges of the sections.

        `share` (..., m) of the sections' extent along the abscissa lies upstream of the reference point, and `extent`
        (..., m) [m] is that extent: in length along the stream line, or the abscissa's own in planes of true lengths.
        Raises DesignError where an edge would lie past the flow path.
        """
        found = self._in_plane(share, extent)
        ends = concatenated([(-share * found)[..., None], (found - share * found)[..., None]], axis=-1)
        t = self.lines.t(self.lines.u_at(ends))
        return self.lines.between(t[..., 0], t[..., 1])

    def _in_plane(self, share: Array, extent: Array) -> Array:
        wanted, own, real = real_first(extent, 1), real_first(share, 1), self._real
        low, high = real.reach()
        with np.errstate(divide="ignore"):
            most = np.minimum(-low / np.maximum(own, 0.0), high / np.maximum(1.0 - own, 0.0)) * (1.0 - ROUNDING)
        if self.lines.mapping.true_lengths:
            self._check(wanted, most)
            return extent
        self._check(wanted, _length(real, own, most)[0])
        found = _solved(real, own, wanted, most)
        if not (np.iscomplexobj(self.lines.leading) or np.iscomplexobj(share) or np.iscomplexobj(extent)):
            return found
        there, slope = _length(self.lines, share, found)
        return np.asarray(found - 1j * np.imag(there - extent) / real_first(slope, 1))

    @cached_property
    def _real(self) -> BladeStreamlines:
        return self.lines.real() if np.iscomplexobj(self.lines.leading) else self.lines

    def _check(self, extent: Reals, longest: Reals) -> None:
        over = extent - longest
        if np.max(over) <= 0.0:
            return
        i = int(np.argmax(over / extent))
        v = self.lines.v[[i]]
        x, r = real_first(self.surfaces.position(v, self.at[[i], None]), 3)[0, 0]
        raise DesignError(
            f"stacking.chord: at v = {v[0]:.4g} the section is {extent[i]:.5g} m long along the flow, and about its "
            f"reference point at (x, r) = ({x:.5g}, {r:.5g}) m there is room for {longest[i]:.5g} m in the flow path: "
            "shorten the chord, lengthen hub and shroud, or move the reference point"
        )


def chord_placement(
    surfaces: StreamSurfaces, v: Reals, mapping: StreamSurfaceMap, t: Array, chord: Array
) -> ChordPlacement:
    """The ruler around reference points at t (..., m) for sections of a chord (..., m) [m]."""
    at = real_first(t, 1)
    unit = real_first(chord, 1) / length(real_first(surfaces.position(v, at[:, None], 1), 3)[:, 0])
    lines = blade_streamlines(surfaces, v, mapping, t, t + unit, before=REACH, after=REACH)
    return ChordPlacement(lines=lines, surfaces=surfaces, at=at)


def _length(ruler: BladeStreamlines, share: Array, extent: Array) -> tuple[Array, Array]:
    """Length (..., m) along the stream line between edges `extent` apart in the plane, and its derivative by that."""
    shares = concatenated([share[..., None], (1.0 - share)[..., None]], axis=-1)
    u = ruler.u_at(extent[..., None] * shares * np.array([-1.0, 1.0]))
    along = ruler.meridional(u)
    slope = length(ruler.position(u, 1)) / ruler.densities(u)[0]
    return along[..., 1] - along[..., 0], np.sum(shares * slope, axis=-1)


def _solved(ruler: BladeStreamlines, share: Reals, wanted: Reals, most: Reals) -> Reals:
    """Real extents in the plane (m,), up to `most`, of sections `wanted` long, by Newton's method.

    Length grows with the extent.
    """
    speed, density = length(ruler.position(_START, 1))[:, 0], ruler.densities(_START)[0][:, 0]
    found = np.minimum(wanted * density / speed, 0.9 * most)
    for _ in range(STEPS):
        there, slope = _length(ruler, share, found)
        after = np.clip(found - (there - wanted) / slope, 0.1 * found, 0.5 * (found + most))
        step, found = after - found, after
        if np.max(np.square(step / found)) < CONVERGED**2:
            break
    return found
