"""What the numbers of a first guess of a blade matter: each is halved and doubled, and the slices are made anew.

    python design/first_guesses.py > design/first_guesses.md

The figure is the mean distance of the points from the slices of the best channel, over that with the number as it is:
the geometric mean over the clouds, and the largest. A search of the real blade follows, so that a ratio of 2 is little.
"""

import ast
import inspect

import matching_clouds as clouds
import numpy as np
from foreign_blades import SHAPES

from bladewright.errors import BladewrightError
from bladewright.fitting.clouds.thinning import even_subset
from bladewright.fitting.initial_guess import blade, channel, meridional_outline, slices

MEASURED, EXAMPLES, FOREIGN = ("Rotor67",), ("compressor-stator", "wedge-diffuser"), ("radial-stator", "twisted-blunt")
WHOLE = {"TURNS", "BANDS", "BAND_POINTS", "EDGE_SHARE", "LAW_COUNT", "RING_PLACES", "FINE_PER_PLACE", "CORNER_REACH"}
WHOLE |= {"NEAR_PLACES", "BORDER_POINTS"}


def machines():
    """The points of every cloud, and which of them a first guess slices."""
    found = {name: clouds.measured(name).points for name in MEASURED}
    found |= {name: clouds.cloud_of(clouds.example(name)).points for name in EXAMPLES}
    found |= {name: SHAPES[name]().points(np.random.default_rng(11)) for name in FOREIGN}
    return {name: (points, even_subset(points, blade.DRAWN_POINTS)) for name, points in found.items()}


def numbers(module):
    """The names of the module's own numbers."""
    for node in ast.parse(inspect.getsource(module)).body:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                for name in ast.walk(target):
                    if isinstance(name, ast.Name) and isinstance(getattr(module, name.id), (int, float)):
                        yield name.id


def distances(of):
    """Mean distances from the best slices, of the chord; infinite where there are none."""
    found = []
    for points, rows in of.values():
        try:
            found.append(channel.ranked_channels(points, rows, "annular")[0].mean_distance)
        except (BladewrightError, ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError):
            found.append(np.inf)
    return np.array(found)


def main():
    """The table."""
    of = machines()
    usual = distances(of)
    print("# The numbers of a first guess\n\nMade by `python design/first_guesses.py`.\n")
    print("| cloud | mean distance from the slices, of the chord |\n|---|---|")
    for name, value in zip(of, usual, strict=True):
        print(f"| {name} | {value:.1e} |")
    print("\n| number | value | halved: mean, largest ratio | doubled |\n|---|---|---|---|", flush=True)
    for module in (meridional_outline, channel, slices):
        for name in numbers(module):
            value, row = getattr(module, name), []
            for factor in (0.5, 2.0):
                setattr(module, name, max(1, round(factor * value)) if name in WHOLE else factor * value)
                ratio = distances(of) / usual
                row.append(f"{np.exp(np.mean(np.log(ratio))):.2f}, {np.max(ratio):.2f}")
            setattr(module, name, value)
            where = module.__name__.rpartition(".")[2]
            print(f"| {where}.{name} | {value:.4g} | {row[0]} | {row[1]} |", flush=True)


if __name__ == "__main__":
    main()
