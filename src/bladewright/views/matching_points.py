"""What a picture of a fit needs of it, and which points of a large cloud are drawn."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from numpy.typing import NDArray

from bladewright.nurbs.basis import Reals
from bladewright.views.style import INK, MILLIMETRES

Index = NDArray[np.intp]
SIDES = ("upper", "lower")
WORST = 500
"""points farthest off that are always drawn"""
COLOURS = LinearSegmentedColormap.from_list(
    "deviation", ["#0b3c66", "#2f7fb5", "#8fbfd9", "#f4f1ea", "#e9a582", "#c4553f", "#7a1526"]
)
"""inside the blade blue, outside red"""
ROUND = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


class Spread(Protocol):
    """Figures of some distances [m]."""

    @property
    def count(self) -> int: ...
    @property
    def mean(self) -> float: ...
    @property
    def rms(self) -> float: ...
    @property
    def percentile_99(self) -> float: ...
    @property
    def maximum(self) -> float: ...


class Matched(Protocol):
    """A fit of a design to a cloud of n points, as `bladewright.fit` hands it back."""

    @property
    def design(self) -> Any: ...
    @property
    def built(self) -> Any: ...
    @property
    def cloud(self) -> Reals: ...
    @property
    def places(self) -> NDArray[np.str_]: ...
    @property
    def u(self) -> Reals: ...
    @property
    def v(self) -> Reals: ...
    @property
    def deviations(self) -> Reals: ...
    @property
    def regions(self) -> NDArray[np.str_]: ...
    @property
    def inliers(self) -> NDArray[np.bool_]: ...
    @property
    def estimates(self) -> Any: ...
    @property
    def rank(self) -> int: ...
    @property
    def noise(self) -> float: ...
    @property
    def extrema(self) -> Mapping[str, int]: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def failures(self) -> tuple[str, ...]: ...
    @property
    def interrupted(self) -> bool: ...
    @property
    def passed(self) -> bool: ...
    @property
    def deviation(self) -> Spread: ...
    @property
    def by_region(self) -> Mapping[str, Spread]: ...


def on_sides(fit: Matched) -> NDArray[np.bool_]:
    """Whether each point (n,) lies nearest to a side, rather than to an end."""
    return np.isin(fit.places, SIDES)


def drawn(fit: Matched, among: NDArray[np.bool_], most: int) -> Index:
    """Indices of at most about `most` points among a mask (n,), those far off last; the worst are always there.

    The rest is an even choice, the same one every time.
    """
    index = np.flatnonzero(among)
    off = np.abs(fit.deviations[index])
    if len(index) > most:
        order = np.argpartition(off, -min(WORST, most // 2))
        near, far = np.split(order, [len(order) - min(WORST, most // 2)])
        chosen = np.random.default_rng(0).choice(near, most - len(far), replace=False)
        index, off = index[np.append(chosen, far)], off[np.append(chosen, far)]
    return index[np.argsort(off, kind="stable")]


def millimetres(fit: Matched, index: Index) -> Reals:
    """Signed deviations of points [mm]."""
    return fit.deviations[index] * MILLIMETRES


def scale_of(fit: Matched) -> Normalize:
    """Colours of deviations [mm]: symmetric about 0, up to a round number that 99 of 100 inliers stay below."""
    off = np.abs(fit.deviations[fit.inliers])
    most = float(np.percentile(off, 99.0)) * MILLIMETRES if len(off) else 0.0
    limit = rounded_up(most) if most > 0.0 else 1.0
    return Normalize(-limit, limit, clip=True)


def rounded_up(value: float) -> float:
    """The next round number at or above a positive value."""
    decade = 10.0 ** np.floor(np.log10(value))
    return float(next(each for each in ROUND if each * decade >= value * (1.0 - 1e-9)) * decade)


def cross(axes: Axes, abscissae: Reals, ordinates: Reals, few: int) -> None:
    """Draws a cross for each outlier, smaller and fainter where there are more than a few: they must hide nothing."""
    share = min(1.0, few / max(len(abscissae), 1))
    size = max(6.0 * share**0.5, 1.4)
    style: dict[str, Any] = {"markersize": size, "markeredgewidth": 0.2 * size, "alpha": max(share**0.4, 0.08)}
    axes.plot(abscissae, ordinates, color=INK, linestyle="none", marker="x", rasterized=True, **style)


def counted(number: int, what: str) -> str:
    """A number with its thousands apart, and what it counts."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
