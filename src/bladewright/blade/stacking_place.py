"""Where reference points stand on the stream lines of a flow path."""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from bladewright.blade.bladed_lines import bladed_lines, labels
from bladewright.blade.edge_crossing import Meeting, crossed
from bladewright.blade.mapping import Cascade
from bladewright.blade.meridian_line import MeridianLine, real_first, spline_on
from bladewright.blade.stacking import HUB_PLACES, Stacking
from bladewright.blade.stacking_nearest import Trajectory, trajectory
from bladewright.blade.stream_surfaces import StreamSurfaces
from bladewright.errors import DesignError
from bladewright.numerics.elementary import Array
from bladewright.nurbs.basis import Reals

WIDER = 0.1
"""share of the flow path by which a line of equal x or r reaches past it"""


@dataclass(frozen=True, kw_only=True, eq=False)
class StackingPlace:
    """The reference points of a stacking without edge curves, in a flow path."""

    surfaces: StreamSurfaces
    stacking: Stacking
    metre: float
    """metres in the design's unit of length"""

    def t(self, v: Reals) -> Array:
        """t (..., m) of the reference points at v (m,); raises DesignError where there is none, or more than one."""
        return self.path.t(v) if self.stacking.onwards == "least-distance" else self.meeting(v).t

    def meeting(self, v: Reals) -> Meeting:
        """Where the stream lines at v (m,) meet the stacking line."""
        name = "stacking.line" if self.stacking.line is not None else f"stacking.{self.given}"
        try:
            return crossed(partial(self.surfaces.position, v), self.surfaces.extent, self.line, name, labels(v))
        except DesignError as error:
            if not self.stacking.from_hub:
                raise
            raise DesignError(
                f"{error}; or take stacking.onwards = 'least-distance', for which the stream lines need not have one "
                f"{self.stacking.onwards[-1]} in common"
            ) from error

    @property
    def given(self) -> str:
        """The name of the hub's place."""
        return next(name for name in HUB_PLACES if getattr(self.stacking, name) is not None)

    @cached_property
    def line(self) -> MeridianLine:
        """The stacking line in (x, r), straight where it follows from the hub's point."""
        if self.stacking.line is not None:
            return self.stacking.line.line(self.metre)
        if (self.given, self.stacking.onwards) in (("hub_x", "equal-x"), ("hub_r", "equal-r")):
            return self._straight(self.given[-1], self._value)
        point = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1))[..., 0, 0, :]
        slope = self.surfaces.position(np.zeros(1), real_first(self.hub, 0).reshape(1, 1), 1)[..., 0, 0, :]
        axis = "x" if self.stacking.onwards == "equal-x" else "r"
        which = "xr".index(axis)
        carried = self.hub - real_first(self.hub, 0)
        return self._straight(axis, point[..., which] + carried * slope[..., which])

    @cached_property
    def path(self) -> Trajectory:
        """The line of least distance through the hub's point."""
        return trajectory(self.surfaces, self.hub)

    @cached_property
    def hub(self) -> Array:
        """t (...) of the hub's reference point."""
        at = np.zeros(1)
        if self.given == "hub_m":
            return self._by_length(at)
        line = self._straight(self.given[-1], self._value)
        position = partial(self.surfaces.position, at)
        return crossed(position, self.surfaces.extent, line, f"stacking.{self.given}", ["of the hub"]).t[..., 0]

    @property
    def _value(self) -> Array:
        return np.asarray(self.metre * getattr(self.stacking, self.given))

    def _by_length(self, at: Reals) -> Array:
        low, high = self.surfaces.extent
        whole = bladed_lines(self.surfaces, at, Cascade(), np.array([low]), np.array([high]), before=0.0, after=0.0)
        asked, there = float(real_first(self._value, 0)), float(real_first(whole.lengths, 1)[0])
        if not 0.0 < asked < there:
            raise DesignError(
                f"stacking.hub_m is {asked / self.metre:g}: the hub is {there / self.metre:.6g} long from its start to "
                "its end, and the reference point must lie between; give a place on the hub, or lengthen it"
            )
        return whole.t(whole.u_at(self._value[..., None, None]))[..., 0, 0]

    def _straight(self, axis: str, value: Array) -> MeridianLine:
        """The line of one x, or one r, through the whole flow path."""
        real = self.surfaces.real()
        grid = real.grid(np.linspace(*real.extent, 33), np.linspace(0.0, 1.0, 17))[0].reshape(-1, 2)
        other = grid[:, 1 if axis == "x" else 0]
        room = WIDER * (float(np.max(other)) - float(np.min(other)))
        across = np.array([np.min(other) - room, np.max(other) + room])
        held = value[..., None] * np.ones(2)
        pair = (held, np.broadcast_to(across, held.shape))
        return spline_on(np.stack(pair if axis == "x" else pair[::-1], axis=-1), 1)
