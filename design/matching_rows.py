"""The rows of design/matching.py: their clouds, what the fit is given, and what is asked of it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import hold_outs
import matching_clouds as clouds
import matching_measures as measures
import numpy as np
from foreign_blades import EDGES, SHAPES
from matching_clouds import Cloud

from bladewright.files.examples import example_text, examples
from bladewright.files.families import family_of
from bladewright.files.reading import design_from, parsed


@dataclass(frozen=True, kw_only=True)
class Row:
    """A row of the table."""

    name: str
    group: str
    cloud: Callable[[Path], Cloud]
    options: dict = field(default_factory=dict)
    asked: dict = field(default_factory=dict)
    """what is asked: the most of a figure, or `passed`, `full rank`, `words` of a refusal, `times` another row"""
    limit: float
    """processor seconds at which it is killed"""
    reach: Callable = lambda cloud, options, _: measures.reached_by_call(cloud, options)


WELL = {"full rank": True, "condition": 1e8, "passed": True}
"""asked of every match whose structure is not given"""
PEER = {
    # parameters, mean mm, seconds; with a tolerance of 0.05 mm: parameters, seconds
    "LS89": (22, 0.012, 2, 28, 3),
    "T106": (22, 0.018, 2, 25, 3),
    "Impulse": (22, 0.065, 2, 37, 3),
    "Aachen": (26, 0.021, 20, 30, 10),
    "Rotor67": (107, 0.03, 20, 140, 40),
    "APU": (101, 0.016, 20, 78, 40),
}
"""what is asked of the measured clouds"""
FLAT = ("LS89", "T106", "Impulse")


def shared():
    """The measured clouds."""
    for name, (count, mean, seconds, most, slower) in PEER.items():
        cloud = partial(lambda of, _: clouds.measured(of), name)
        yield Row(
            name=f"{name}-parameters",
            group="shared-parameters",
            cloud=cloud,
            options={"parameters": count},
            asked={"mean mm": mean, "parameters": count, "seconds": seconds, "passed": True},
            limit=60.0 if name in FLAT else 120.0,
        )
        yield Row(
            name=f"{name}-tolerance",
            group="shared-tolerance",
            cloud=cloud,
            options={"tolerance": 5e-5},
            asked={"max mm": 0.05, "parameters": int(1.15 * most), "seconds": slower, "passed": True},
            limit=60.0 if name in FLAT else 240.0,
        )
        yield Row(
            name=f"{name}-free",
            group="shared-free",
            cloud=cloud,
            asked={"max of chord": 1e-3, **WELL, "seconds": 3 if name in FLAT else 60},
            limit=60.0 if name in FLAT else 240.0,
        )
    for name, mean in {"LS89": 0.0121, "T106": 0.0124, "Impulse": 0.0381, "Aachen2D": 0.0114}.items():
        yield Row(
            name=f"{name}-suction-pressure",
            group="shared-family",
            cloud=partial(lambda of, _: clouds.measured(of), name),
            options={"family": "suction-pressure", "parameters": 28},
            # a tenth more than was reached before
            asked={"mean mm": round(1.1 * mean, 4), "passed": True},
            limit=120.0,
        )
    for name in ("LS89", "Impulse", "Aachen", "Aachen2D"):
        yield Row(
            name=f"{name}-third",
            group="brought",
            cloud=partial(lambda of, _: clouds.measured_third(of), name),
            asked={"max of chord": 2e-3, "passed": True},
            limit=120.0,
        )


def of_shape(name, noise=0.0, outliers=0.0):
    """The cloud of a shape of no family here."""
    shape, draw = SHAPES[name](), np.random.default_rng(11)
    points, others = shape.points(draw), shape.others(draw)
    points, outlier = clouds.with_outliers(clouds.noisy(points, draw, noise), draw, outliers, 5e-4, 4e-3)
    return Cloud(points=points, others=others, outlier=outlier if outliers else None)


def foreign():
    """Shapes of no family here."""
    for name, count in {
        "impulse-sharp": 22,
        "impulse-thin": 22,
        "orc-nozzle": 22,
        "radial-stator": 26,
        "radial-diffuser": 26,
        "ship-propeller": 113,
    }.items():
        flat = count == 22
        cloud = partial(lambda of, _: of_shape(of), name)
        yield Row(
            name=f"{name}-parameters",
            group="foreign",
            cloud=cloud,
            options={"parameters": count},
            asked={"mean of chord": 1e-3, "parameters": count, "seconds": 2 if flat else 20, "passed": True},
            limit=60.0 if flat else 120.0,
        )
        yield Row(
            name=f"{name}-free",
            group="foreign",
            cloud=cloud,
            asked={"max of chord": 1e-3, **WELL, "seconds": 3 if flat else 60},
            limit=60.0 if flat else 240.0,
        )
    yield Row(
        name="orc-nozzle-camber-angle",
        group="foreign",
        cloud=lambda _: of_shape("orc-nozzle"),
        options={"parameters": 22, "family": "camber-angle"},
        asked={"mean of chord": 1e-3, "parameters": 22, "passed": True},
        limit=60.0,
    )


def naca():
    """NACA sections and blades with every kind of trailing edge, without and with noise and outliers."""
    noise = 2e-5
    for name in SHAPES:
        if not name.startswith(("naca", "twisted")):
            continue
        back = EDGES[name.split("-")[1].replace("tip", "blunt")][1]
        for noisy in (False, True):
            for family in ("profile", "unified"):
                most = noise if noisy else 1e-4 * SHAPES[name]().chord
                # the unified family has round edges: half the thickness of a blunt one is left
                most += back / 2.0 if family == "unified" and "round" not in name else 0.0
                yield Row(
                    name=f"{name}-{'noisy' if noisy else 'exact'}-{family}",
                    group="naca",
                    cloud=partial(lambda of, n, o, _: of_shape(of, n, o), name, noise * noisy, 0.01 * noisy),
                    options={"family": family},
                    asked={"max mm": round(1e3 * most, 4), **WELL, "seconds": 30},
                    limit=120.0,
                )


def all_examples():
    """Every example, by its points and its family alone; twice more by other points."""
    for name in examples():
        family = family_of(design_from(parsed(example_text(name), name), name))
        for seed in (4, 5, 6):
            yield Row(
                name=f"example-{name}" if seed == 4 else f"again-{seed}-{name}",
                group="examples" if seed == 4 else "again",
                cloud=partial(lambda of, draw, _: clouds.cloud_of(clouds.example(of), draw), name, seed),
                options={"family": family},
                asked={"max of chord": 1e-4, **WELL, "seconds": 60},
                limit=180.0,
            )


def drawn():
    """Designs of the unified family drawn at random, with their structure given and without."""
    seeds = [("section", seed) for seed in (*range(6), 38, 44)] + [("blade", seed) for seed in (6, 7, 10, 22, 24, 27)]
    for kind, seed in seeds:
        for given in (True, False):
            flat = kind == "section"
            yield Row(
                name=f"drawn-{kind}-{seed}-{'like' if given else 'free'}",
                group="drawn",
                cloud=partial(lambda k, s, _: clouds.cloud_of(getattr(clouds, k)(s), s), kind, seed),
                options={"like": True} if given else {},
                asked={"max of chord": 1e-4, **({"passed": True} if given else WELL), "seconds": 10 if flat else 60},
                limit=60.0 if flat else 180.0,
                reach=lambda cloud, options, _: measures.reached_by_call(
                    cloud, {**options, **({"like": cloud.design} if "like" in options else {})}
                ),
            )


def intervals():
    """How often 95 % intervals hold the truth, and outliers: noise 1e-4 of the chord, 3 % outliers, structure given."""
    for batch in range(10):
        yield Row(
            name=f"intervals-{batch}",
            group="intervals",
            cloud=lambda _: None,
            options={"seeds": range(20 * batch, 20 * batch + 20)},
            asked={"kept": 0, "dropped": 20},
            limit=300.0,
            reach=lambda _, options, __: counted(options["seeds"]),
        )


def counted(seeds):
    """Of matches of sections about an example with 1,000 points: true values inside, outliers kept, points dropped."""
    from fit_intervals import BASE
    from fit_intervals import drawn as drawn_about

    import bladewright as bw

    sums = dict.fromkeys(("inside", "known", "planted", "kept", "good", "dropped", "runs"), 0)
    start = time.process_time()
    for seed in seeds:
        truth, draw = drawn_about(seed), np.random.default_rng(100 + seed)
        built = truth.build()
        noise = 1e-4 * float(np.real(built.chord))
        exact = clouds.points_of(built, 1000, draw)
        points = clouds.noisy(exact, draw, noise)
        outlier = np.zeros(len(points), dtype=bool)
        outlier[draw.choice(len(points), round(0.03 * len(points)), replace=False)] = True
        todo = np.flatnonzero(outlier)
        while len(todo):
            moved = clouds.with_outliers(exact[todo], draw, 1.0, 10.0 * noise, 100.0 * noise)[0]
            points[todo] = moved
            todo = todo[measures.distances(moved, clouds.sides_of(built)) < 10.0 * noise]
        found, values = bw.fit(points, like=BASE), truth.parameters()
        inside = [each.low <= values[each.path] <= each.high for each in found.estimates if each.identified]
        sums["runs"] += 1
        sums["inside"] += sum(inside)
        sums["known"] += len(inside)
        sums["planted"] += int(np.count_nonzero(outlier))
        sums["kept"] += int(np.count_nonzero(outlier & found.inliers))
        sums["good"] += int(np.count_nonzero(~outlier))
        sums["dropped"] += int(np.count_nonzero(~outlier & ~found.inliers))
    share = sums["inside"] / sums["known"]
    words = f"{share:.3f} of {sums['known']} true values inside in {sums['runs']} runs"
    return {**sums, "status": "passed", "seconds": time.process_time() - start, "words": words}


def many():
    """An example with noise of 0.01 mm in 10,000 and 1,000,000 points."""

    def cloud(count, _):
        draw = np.random.default_rng(3)
        sides = clouds.example("aachen-stator").build().sides
        points = clouds.noisy(clouds.scattered(sides, count, draw), draw, 1e-5)
        return Cloud(points=points, others=clouds.scattered(sides, 8000, draw))

    for count in (10_000, 1_000_000):
        yield Row(
            name=f"many-{count}",
            group="many",
            cloud=partial(cloud, count),
            asked={"max of chord": 1e-3, **WELL, **({"times": ("many-10000", 4.0)} if count > 10_000 else {})},
            limit=120.0 if count == 10_000 else 600.0,
        )


def by_command():
    """What is given to the command: STEP files, and clouds as users bring them."""

    def step(name, directory):
        from bladewright import cad

        built = clouds.example(name).build()
        cad.write(built, directory / "cloud.step", samples=500)
        return Cloud(points=np.empty((0, 3)), others=clouds.points_of(built, 8000, np.random.default_rng(7)))

    for name in ("aachen-stator", "compressor-stator"):
        yield Row(
            name=f"step-{name}",
            group="step",
            cloud=partial(step, name),
            asked={"max of chord": 1e-3, "passed": True, "seconds": 30},
            limit=180.0,
            reach=lambda cloud, _, directory: measures.reached_by_command(
                cloud, (), directory, directory / "cloud.step"
            ),
        )
    for name, (machines, _, words) in clouds.VARIATIONS.items():
        for machine in machines:
            yield Row(
                name=f"{machine}-{name}",
                group="brought",
                cloud=partial(clouds.brought, machine, name),
                asked={"words": words} if words else {"max of chord": 1e-3, "passed": True},
                limit=180.0,
                reach=lambda cloud, _, directory: measures.reached_by_command(cloud, cloud.options, directory),
            )


def interrupted():
    """Ctrl-C after some seconds of processor time."""
    for name, seconds in (("LS89", 2.0), ("LS89", 3.0), ("LS89", 4.0), ("Aachen", 4.0), ("Aachen", 8.0)):
        yield Row(
            name=f"interrupt-{name}-{seconds:.0f}",
            group="interrupt",
            cloud=partial(lambda of, _: clouds.measured(of), name),
            options={"after": seconds},
            asked={"seconds": 2.0, "passed": True},
            limit=60.0,
            reach=stopped,
        )


def stopped(cloud, options, directory):
    """Seconds from Ctrl-C to the end of the command, which leaves a design and its report, or neither."""
    np.savetxt(directory / "cloud.csv", cloud.points * 1e3, delimiter=",")
    # a shell's background jobs ignore Ctrl-C, and so would what they start
    signal.signal(signal.SIGINT, signal.default_int_handler)
    child = subprocess.Popen(
        [sys.executable, "-m", "bladewright", "fit", "cloud.csv", "--unit", "mm", "-o", "found.toml"],
        cwd=directory,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )

    def spent():
        try:
            words = Path(f"/proc/{child.pid}/stat").read_text().rpartition(")")[2].split()
        except FileNotFoundError:
            return np.inf
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    while child.poll() is None and spent() < options["after"]:
        time.sleep(0.02)
    before = last = spent()
    if child.poll() is None:
        child.send_signal(signal.SIGINT)
    while child.poll() is None and spent() < before + 20.0:
        last = spent()
        time.sleep(0.01)
    child.kill()
    out, err = child.communicate()
    if not np.isfinite(before):
        return {"status": "broke", "seconds": 0.0, "words": "ended before it was interrupted"}
    there = [(directory / each).exists() for each in ("found.toml", "found.fit.json")]
    words = f"exit {child.returncode}, design and report {there}; {(err or out).strip().splitlines()[-1:]}"
    return {
        # interrupted in the import of a compiled module, Python ends by the signal, which shells report as 130 too
        "status": "passed" if there[0] == there[1] and child.returncode in (130, -signal.SIGINT) else "not passed",
        "seconds": max(0.0, last - before),
        "words": words,
    }


def held_out():
    """The hold-outs, and those that have been opened."""
    for name in hold_outs.ALL:
        yield Row(
            name=name,
            group="hold-outs" if name in hold_outs.SEEDS else "opened",
            cloud=partial(lambda of, _: hold_outs.cloud(of), name),
            asked={"max of chord": hold_outs.most(name), **WELL, "seconds": 60},
            limit=240.0,
            reach=lambda cloud, _, __: measures.reached_by_call(*hold_outs.told(cloud)),
        )


ROWS = {
    row.name: row
    for rows in (shared, foreign, naca, all_examples, drawn, intervals, many, by_command, interrupted, held_out)
    for row in rows()
}
"""all rows by name"""
HOLD_OUTS = frozenset(hold_outs.SEEDS)
