"""Blades as a search sees them: how places on their sides move, by what their sections do at few span fractions."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from bladewright.blade.native.blade import Blade
from bladewright.blade.native.knots import DEGREE, Knots, clamped
from bladewright.derivatives.complex_step import Nets, side_tangents, step_tangents, steps_of
from bladewright.fitting.matching.footpoints import Footpoints
from bladewright.fitting.models.model import Model, ModelShape
from bladewright.frozen import FrozenMapping
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.collocation import collocation
from bladewright.nurbs.surface import Surface


class SpatialModel(Model):
    """A kind of blade, at the knots that one design needs for a tolerance."""

    knots: Knots

    @abstractmethod
    def _closed(self, upper: Reals, lower: Reals) -> Nets:
        """Rates (k, n_u, n_v, 3) of the sides that close the blade by those of the native sides."""

    def tangents(self, shape: ModelShape, paths: Sequence[str]) -> tuple[Reals, Reals]:
        """By all parameters that move a section by their weight at its span fraction in one step."""
        pairs = list(side_tangents(self._blade(shape, self.knots), paths))
        upper, lower = (np.concatenate([pair[side] for pair in pairs]) for side in (0, 1))
        return self._closed(upper, lower)

    def along(self, shape: ModelShape, footpoints: Footpoints, directions: Reals, paths: Sequence[str]) -> Reals:
        """By the weights at the footpoints themselves, times what a common step of several parameters does there.

        That changes along the span as laws' values do, so that it is interpolated between a knot for each control point
        of the longest law.
        """
        steps, sources = steps_of(shape.design, paths)
        spans = max(len(step.paths) for step in steps)
        knots = replace(self.knots, v=clamped(np.linspace(0.0, 1.0, spans + 1)[1:-1]), sections=None)
        nets = self._closed(*step_tangents(self._blade(shape, knots), steps))
        rates = np.empty((len(footpoints.u), len(steps)))
        for number, (side, net) in enumerate(zip(shape.sides, nets, strict=True)):
            rows = np.flatnonzero(footpoints.side == number)
            on = Surface(
                control_points=net[0],
                knots_u=cast(Surface, side).knots_u,
                knots_v=knots.v,
                degree_u=DEGREE,
                degree_v=DEGREE,
            )
            matrix = collocation(on, footpoints.u[rows], footpoints.v[rows])
            columns = np.moveaxis(net, 0, 2).reshape(matrix.shape[1], -1)
            moved = (matrix @ columns).reshape(len(rows), len(steps), 3)
            rates[rows] = np.einsum("nkd,nd->nk", moved, directions[rows])
        weights = [step.weights(footpoints.v) for step in steps]
        return np.stack([rates[:, step] * weights[step][:, place] for step, place in sources], axis=1)

    def _blade(self, shape: ModelShape, knots: Knots) -> Blade:
        return Blade(design=shape.design, surfaces=FrozenMapping({}), knots=knots, chord=self.chord, exact=shape.exact)
