"""A unified blade drawn at random within wide bounds: the more `wild`, the less of it can be built."""

import numpy as np

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.section.checks import UNITS


def random_design(seed):
    """The design of a seed; raises DesignError where its numbers alone are refused."""
    return UnifiedBlade(**random_fields(seed))


def random_fields(seed):
    """The fields of the design of a seed."""
    draw = np.random.default_rng(seed)
    unit = str(draw.choice(["mm", "mm", "mm", "m", "cm", "um", "in", "ft"]))
    linear = draw.random() < 0.2
    wild = draw.random()
    channel, shape = random_channel(draw, wild, linear=linear, size=0.1 / UNITS[unit])
    length, radius = channel.pop("length"), channel.pop("radius")
    stagger = draw.uniform(-80.0, 80.0)
    bound = 95.0 if draw.random() < 0.03 else 86.0
    turn = 20.0 + 70.0 * wild
    angles = {
        "stagger": law(draw, stagger, 5.0 + 25.0 * wild, bound - 3.0),
        "metal_angle_in": law(draw, stagger + draw.uniform(-turn, turn), 5.0 + 25.0 * wild, bound),
        "metal_angle_out": law(draw, stagger + draw.uniform(-turn, turn), 5.0 + 25.0 * wild, bound),
    }
    thickness = np.exp(draw.uniform(np.log(0.01), np.log(0.3)))
    share = np.exp(draw.uniform(np.log(0.02), np.log(1.0), 2))
    blade = {
        "name": f"random-{seed}",
        "description": f"{shape}, seed {seed}",
        "length_unit": unit,
        "arrangement": "linear" if linear else "annular",
        "channel": channel,
        **angles,
        "tangent_in": law(draw, draw.uniform(0.1, 0.9), 0.1, (0.02, 1.0)),
        "tangent_out": law(draw, draw.uniform(0.1, 0.9), 0.1, (0.02, 1.0)),
        "leading_edge_radius": law(draw, share[0] * thickness, 0.3 * share[0] * thickness, (1e-4, 0.5)),
        "trailing_edge_radius": law(draw, share[1] * thickness, 0.3 * share[1] * thickness, (1e-4, 0.5)),
        "thickness_upper": chordwise(draw, thickness),
        "thickness_lower": chordwise(draw, thickness * draw.uniform(0.4, 1.6)),
        "samples": int(draw.choice([16, 16, 16, draw.integers(3, 41)])),
        "clustering": float(draw.choice([1.0, 1.0, draw.random()])),
        "mapping": "paper" if draw.random() < 0.05 else "conformal",
        "tolerance": float(draw.choice([1e-6, 1e-6, 1e-6, 1e-8, 1e-7, 1e-5, 1e-4])),
    }
    if draw.random() < 0.2:
        side = str(draw.choice(["upper", "lower"]))
        blade[f"weights_{side}"] = tuple(law(draw, draw.uniform(0.7, 1.5), 0.1, (0.3, 3.0)) for _ in counts(draw, 6))
    # from a tenth of the meridional length a blade to four of them
    solidity = np.exp(draw.uniform(np.log(0.25), np.log(4.0)))
    if linear:
        blade["pitch"] = float(length / solidity)
        blade["leading_edge_y"] = law(draw, 0.0, 0.2 * length, (-9e9, 9e9))
    else:
        blade["blade_count"] = int(np.clip(round(2.0 * np.pi * radius / length * solidity), 1, 200))
        blade["leading_edge_theta"] = law(draw, draw.uniform(-180.0, 180.0), 4.0, (-9e9, 9e9))
    return {**blade, **random_clearance(seed, channel), "channel": Channel(**channel)}


def random_shape(seed):
    """The kind of channel of a seed."""
    return random_fields(seed)["description"].split(",")[0]


def random_clearance(seed, channel):
    """A gap at one end of some blades, of a thousandth to a tenth of the span, drawn apart from the rest."""
    draw = np.random.default_rng([seed, 1])
    if draw.random() > 0.3:
        return {}
    ends = [np.array(channel[edge][-1]) - np.array(channel[edge][0]) for edge in ("leading_edge", "trailing_edge")]
    spans = [float(np.sqrt(np.sum(end**2))) for end in ends]
    gap = tuple(float(span * np.exp(draw.uniform(np.log(1e-3), np.log(0.1)))) for span in spans)
    name = "tip_clearance" if draw.random() < 0.7 else "hub_clearance"
    return {name: gap if draw.random() < 0.5 else min(gap)}


def random_channel(draw, wild, *, linear, size):
    """Control points of a channel around a mean line that turns from one meridional angle to another, and its name."""
    shape = str(draw.choice(["axial", "radial outward", "radial inward", "mixed", "any"])) if not linear else "linear"
    start, end = {
        "linear": draw.uniform(-15.0, 15.0, 2),
        "axial": draw.uniform(-25.0, 25.0, 2),
        "radial outward": (draw.uniform(-10.0, 40.0), draw.uniform(60.0, 95.0)),
        "radial inward": (draw.uniform(-95.0, -60.0), draw.uniform(-30.0, 15.0)),
        "mixed": draw.uniform(15.0, 65.0, 2),
        "any": draw.uniform(-100.0, 100.0, 2),
    }[shape]
    length = size * np.exp(draw.uniform(np.log(0.05), np.log(20.0)))
    span = length * np.exp(draw.uniform(np.log(0.15), np.log(2.5)))
    phi = np.radians(np.linspace(start, end, 65))
    step = length / 64.0 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    middle = np.concatenate([[[0.0, 0.0]], np.cumsum((step[1:] + step[:-1]) / 2.0, axis=0)])
    normal = np.stack([-np.sin(phi), np.cos(phi)], axis=-1)
    width = span * np.linspace(1.0, draw.uniform(0.4, 1.3), 65)[:, None]
    hub, shroud = middle - width / 2.0 * normal, middle + width / 2.0 * normal
    lowest, highest = (float(f(np.concatenate([hub, shroud])[:, 1])) for f in (np.min, np.max))
    clearance = (highest - lowest) * np.exp(draw.uniform(np.log(0.08), np.log(12.0)))
    lift = np.array([length * draw.uniform(-1.0, 1.0), clearance - lowest])
    noise = 0.1 * length * wild**2

    def wall(line):
        places = np.linspace(0, 64, len(counts(draw, 5)) + 1).round().astype(int)[1:-1]
        return pairs(line[places] + lift + noise * draw.normal(size=(len(places), 2)))

    def edge(at):
        count = len(counts(draw, 5)) + 1
        t = np.linspace(0.0, 1.0, count)[:, None]
        points = hub[at] + t * (shroud[at] - hub[at]) + lift
        return pairs(points + noise * draw.normal(size=(count, 2)))

    channel = {"leading_edge": edge(0), "trailing_edge": edge(-1), "hub": wall(hub), "shroud": wall(shroud)}
    channel["degree"] = int(draw.choice([5, 5, 5, 5, 5, 4, 3, 2, 1]))
    radius = float(np.mean(middle[:, 1])) + lift[1]
    return {**channel, "length": float(length), "radius": radius}, shape


def counts(draw, most):
    """A range of one to `most` control points, few more often than many."""
    return range(int(draw.choice(np.arange(1, most + 1), p=np.arange(most, 0, -1) / (most * (most + 1) / 2))))


def law(draw, mean, spread, bounds):
    """A law of evolution of one to six control points about a mean."""
    low, high = bounds if isinstance(bounds, tuple) else (-bounds, bounds)
    values = np.clip(mean + draw.uniform(-spread, spread, len(counts(draw, 6))), low, high)
    return tuple(float(value) for value in values) if len(values) > 1 else float(values[0])


def chordwise(draw, level):
    """Half thickness along the chord: one to six control points, thinner towards the ends more often than not."""
    inner = len(counts(draw, 6))
    bump = np.sin(np.pi * (np.arange(inner) + 0.7) / (inner + 0.4)) if draw.random() < 0.8 else np.ones(inner)
    return tuple(law(draw, level * value * draw.uniform(0.6, 1.4), 0.15 * level * value, (1e-5, 5.0)) for value in bump)


def pairs(points):
    """Points as plain numbers."""
    return tuple((float(x), float(r)) for x, r in points)
