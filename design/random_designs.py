"""Designs drawn at random: each is refused with a reason, or becomes a solid that passes its round trip.

    python design/random_designs.py --count 2000 --jobs 2 --record design/random_designs.md
    python design/random_designs.py --of sections --count 1000 --jobs 2 --record design/random_sections.md
    python design/random_designs.py --of parts --count 500 --jobs 2 --record design/random_parts.md
    python design/random_designs.py --seed 17 --count 1 --show

A design follows from its seed alone (random_blades.py, random_sections.py, random_parts.py). It is built in a process
that may die, so that a crash of the kernel or a hang is a result like any other. The results of the first commands are
recorded in the files that they name.
"""

import argparse
import multiprocessing
import multiprocessing.connection
import re
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter, defaultdict
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path

import numpy as np
import random_blades
import random_parts
import random_sections

DRAWN = {"unified": random_blades, "sections": random_sections, "parts": random_parts}
"""what designs are drawn by"""

LIMIT = 60.0
"""seconds of processor time that a design may take; ten times as much on the clock"""
RING = 1e-6
"""share of the ring by which blade count times passage and blade may differ from it"""
OPEN = 1e-9
"""summed area vectors of a passage's faces over their area; a trimmed tip is followed within 1e-9 of the chord"""
OPEN_WHEEL = 1e-8
"""the same of a sector or wheel, in whose hub the blade's end is a hole, followed within 1e-7"""
SAMPLES = 2000
"""points on each face, each way, in the round trip"""
TURNED = 1e-9
"""share by which a wheel may differ from its blade count times the sector"""
WHEEL = 12
"""most blades of a wheel that is written as a whole; of others a sector is"""
FINE = frozenset({"built", "no wheel", "blade only", "refused"})
"""what may become of a design"""
REASONS = {
    "which it cannot fill": "blade and wall meet at less than 8 or more than 172 deg",
    "it folds: the corner": "a corner leans over its ball",
    "no ball turns about it": "a corner lies in a hollow",
    "touches the corner and": "no ball touches a corner and its wall",
    "of the span is left": "too little of the span is left above a fillet",
    "CAD programs lose narrower faces": "a fillet is smaller than 1e-4 of the chord",
    "crosses itself": "the foot of a fillet crosses itself",
    "of its radius, at most": "a fillet of kind curvature where a curvature jumps",
    "miss what is promised": "a fillet is not reached within 300 poles along the chord",
    "axes are so unlike": "an ellipse's axes are too unlike for the angle of blade and wall",
    "touches the blade past": "a fillet is higher than its blade",
    "foot lies past the end": "a fillet reaches past the end of its wall",
    "misses the blade": "a cut misses the blade",
    "2 times along": "a cut crosses the blade twice",
    "which is blunt already": "a cut crosses a back face",
    "the cuts cross": "cuts leave nothing of the blade",
    "down to r =": "a cut crosses the axis",
    "no ball of that radius": "no ball touches blade and wall",
    "the fillet of the neighbouring blade": "fillets of neighbours touch",
    "the ball is larger than the hollow": "a fillet is larger than the hollow that it lies in",
    "leave one of the two out": "a fillet or disc at a gap",
    "wheels are annular": "a disc in a cascade",
    "off the hub": "an end of an outline does not lie on the wall",
    "off the shroud": "an end of an outline does not lie on the wall",
    "outline cuts": "an outline cuts its wall or itself",
    "its outline ends at": "a disc ends under the blade or its fillet",
    "the rim would fold": "a rim is thicker than its wall allows",
    "must keep off the axis": "an outline reaches the axis",
    "the passage winds": "the passage winds by a full turn",
    "reaches out of its passage": "a blade or fillet reaches out of its passage",
    "does not run between hub and shroud": "a cut leaves the duct before the passage's ends",
    "outside its": "the blade stands outside its passage",
    "its face": "a patch of a wall would fold over",
    "the continued channel": "the continued channel folds over or meets the axis",
    "off their surfaces of revolution": "walls are not within 1e-7 of their surfaces of revolution",
    "smaller than the span everywhere": "a clearance leaves no blade",
    "the surface at that distance": "a wall bends too much for the surface at a clearance",
    "bounds the blade's own": "the channel below a clearance folds over",
    "is linear in u and falls": "a clearance ends on a nose",
    "an angle must lie between": "an angle of 90 deg or more",
    "the sides cross": "the sides of a section cross",
    "can hold at most": "the thickness cannot hold the edge radius",
    "leaves the blade outwards": "the camber turns too fast for the thickness beside an edge",
    "bends more than such an edge": "the stream surface bends more than the edge",
    "neighbouring blades intersect": "neighbouring blades intersect",
    "folds over": "the channel folds over",
    "ends are swapped": "the channel's ends are swapped",
    "keep clear of the axis": "the channel reaches the axis",
    "cannot be inverted": "a stream line of the channel turns back",
    "outside the channel": "the nose stands too far outside the channel",
    "native surfaces reach": "the tolerance is not reached within 200 x 100 poles",
    "the blade winds": "the blade winds around the axis",
    "is met within": "the clearance surface cannot be followed",
    "cannot be followed": "an end cannot be followed on its wall",
}
"""what a refusal says, and what it is counted as"""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of the design of a seed."""

    seed: int
    kind: str
    """built, no wheel (of a design with a disc), blade only (without its passage), refused, failed, crashed or hung"""
    message: str
    seconds: float
    shape: str


def judged(seed, directory, samples=SAMPLES, of="unified"):
    """What becomes of the design of a seed: its kind, and why."""
    from bladewright.errors import DesignError

    try:
        design = DRAWN[of].random_design(seed)
        blade = design.build()
    except DesignError as error:
        wrong = unclear(str(error))
        return ("failed", f"unclear refusal ({wrong}): {error}") if wrong else ("refused", str(error))
    from bladewright import cad

    for name in ("hub_fillet", "shroud_fillet"):
        if getattr(design, name) is not None and not any(face.startswith(name) for face in blade.surfaces):
            return "failed", f"the blade has no {name}"
    if not blade.conformance.kept:
        broken = {name: getattr(blade.conformance, name) for name in blade.conformance.limits}
        return "failed", f"a promise is not kept: {broken}, limits {blade.conformance.limits}"
    trip = cad.write(blade, Path(directory) / f"{design.name}.step", samples=samples)
    if not trip.passed:
        return "failed", f"round trip: {'; '.join(trip.failures)}"
    kind, message = with_passage(blade)
    carried = design.disc is not None or design.shroud_ring is not None
    return with_wheel(blade, Path(directory), samples) if carried and kind == "built" else (kind, message)


def with_passage(blade):
    """What becomes of the passage around a blade that is built."""
    from bladewright.domain.build import passage
    from bladewright.errors import DesignError

    poles = f"{blade.knots.poles[0]} x {blade.knots.poles[1]} poles"
    try:
        made = passage(blade)
    except DesignError as error:
        wrong = unclear(str(error))
        return ("failed", f"unclear refusal ({wrong}): {error}") if wrong else ("blade only", str(error))
    filled = (blade.design.blade_count or 1) * (made.properties.volume + blade.properties.volume)
    off = filled / made.ring - 1.0
    if not -RING < off < RING:
        return "failed", f"blades and passages differ from the ring by {off:.2g} of its volume"
    if made.properties.openness > OPEN:
        return "failed", f"the passage is open by {made.properties.openness:.2g} of its area"
    return "built", f"{poles}, passage {off:.1e} off the ring"


def with_wheel(blade, directory, samples):
    """What becomes of the wheel that carries a blade, or of a sector of it where it has many."""
    import bladewright as bw
    from bladewright import cad
    from bladewright.errors import DesignError

    try:
        one, whole = bw.sector(blade), bw.wheel(blade)
    except DesignError as error:
        wrong = unclear(str(error))
        return ("failed", f"unclear refusal ({wrong}): {error}") if wrong else ("no wheel", str(error))
    off = blade.design.blade_count * one.properties.volume / whole.properties.volume - 1.0
    if not -TURNED < off < TURNED:
        return "failed", f"sectors differ from the wheel by {off:.2g} of its volume"
    made = whole if blade.design.blade_count <= WHEEL else one
    for body in {one, made}:
        if body.properties.openness > OPEN_WHEEL:
            return "failed", f"the {body.shown_as} is open by {body.properties.openness:.2g} of its area"
    trip = cad.write(made, directory / f"{blade.design.name}.step", samples=samples)
    return (
        ("built", f"with its {made.shown_as}")
        if trip.passed
        else ("failed", f"round trip of the {made.shown_as}: {'; '.join(trip.failures)}")
    )


def unclear(message):
    """What is wrong with a refusal that is not one clear paragraph that names a parameter, or nothing."""
    names = {each.name for kind in _parts() for each in fields(kind)} | {"upstream", "downstream"}
    if "\n" in message or not 40 <= len(message) <= 500:
        return "not one paragraph"
    if not re.search(rf"\b({'|'.join(names)})\b", message):
        return "names no parameter"
    return ""


@cache
def _parts():
    """The classes whose fields are the parameters of designs."""
    from bladewright.designs import Part

    found, todo = [], [Part]
    while todo:
        kind = todo.pop()
        todo += kind.__subclasses__()
        found += [kind] if is_dataclass(kind) else []
    return found


def reason_of(message):
    """What a refusal is counted as."""
    return next((reason for sign, reason in REASONS.items() if sign in message), message[:80])


def _work(pipe):
    with tempfile.TemporaryDirectory() as directory:
        while True:
            seed, samples, limit, of = pipe.recv()
            # the kernel ends a process that reaches it, in compiled code too
            signal.setitimer(signal.ITIMER_PROF, limit)
            start = time.process_time()
            try:
                kind, message = judged(seed, directory, samples, of)
            except Exception:  # noqa: BLE001 - whatever it is, it is what became of the design
                kind, message = "failed", traceback.format_exc()
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            pipe.send((kind, message, time.process_time() - start))


def outcomes(seeds, jobs=1, limit=LIMIT, samples=SAMPLES, of="unified", until=np.inf):
    """Yield the outcome of each seed, in any order, from `jobs` processes that are replaced where they die.

    None is begun after `until` on time.monotonic.
    """
    context = multiprocessing.get_context("spawn")
    todo = list(reversed(seeds))
    workers = [_Worker(context, todo.pop(), limit, samples, of) for _ in range(min(jobs, len(todo)))]
    while workers:
        ready = multiprocessing.connection.wait(
            [waitable for worker in workers for waitable in (worker.pipe, worker.process.sentinel)], timeout=0.2
        )
        for worker in list(workers):
            outcome = worker.outcome(ready)
            if outcome is None:
                continue
            yield outcome
            if todo and time.monotonic() < until:
                worker.ask(todo.pop())
            else:
                worker.end()
                workers.remove(worker)


class _Worker:
    def __init__(self, context, seed, limit, samples, of):
        self.context, self.limit, self.samples, self.of = context, limit, samples, of
        self._start()
        self.ask(seed)

    def _start(self):
        self.pipe, other = self.context.Pipe()
        self.process = self.context.Process(target=_work, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def ask(self, seed):
        self.seed, self.since = seed, time.perf_counter()
        self.pipe.send((seed, self.samples, self.limit, self.of))

    def outcome(self, ready):
        if self.pipe in ready:
            try:
                kind, message, seconds = self.pipe.recv()
            except EOFError:
                return self._replaced()
            return self._outcome(kind, message, seconds)
        if self.process.sentinel in ready or time.perf_counter() - self.since > 10.0 * self.limit:
            return self._replaced()
        return None

    def _replaced(self):
        self.end()
        code = self.process.exitcode
        self._start()
        if code in {-signal.SIGPROF, -signal.SIGKILL}:
            return self._outcome("hung", f"more than {self.limit:g} s", self.limit)
        return self._outcome("crashed", f"exit code {code}", float("nan"))

    def _outcome(self, kind, message, seconds):
        shape = DRAWN[self.of].random_shape(self.seed)
        return Outcome(seed=self.seed, kind=kind, message=message, seconds=seconds, shape=shape)

    def end(self):
        # one that is ending by itself keeps its exit code
        self.process.join(0.5)
        self.process.kill()
        self.process.join()
        self.pipe.close()


def report(found, command):
    """The record of a run, in Markdown."""
    by_kind = defaultdict(list)
    for outcome in found:
        by_kind[outcome.kind].append(outcome)
    lines = [
        "# Random designs",
        "",
        f"`{command}`:",
        f"{len(found)} designs, each refused with one clear paragraph that names a parameter, or built into a STEP",
        "solid that passes its round trip and keeps every promise, and a passage whose volume fills the ring.",
        "",
        "| | designs | processor seconds each: median | 95 % | most |",
        "|---|---|---|---|---|",
    ]
    for kind in ("built", "no wheel", "blade only", "refused", "failed", "crashed", "hung"):
        times = np.array([outcome.seconds for outcome in by_kind[kind]])
        figures = [*np.quantile(times, [0.5, 0.95, 1.0])] if len(times) else []
        row = [f"{figure:.2f}" for figure in figures] or [""] * 3
        lines.append(f"| {kind} | {len(times)} | {' | '.join(row)} |")
    lines += ["", "| drawn | built | no wheel | blade only | refused |", "|---|---|---|---|---|"]
    for shape in sorted({outcome.shape for outcome in found}):
        row = [
            sum(outcome.shape == shape for outcome in by_kind[kind])
            for kind in ("built", "no wheel", "blade only", "refused")
        ]
        lines.append(f"| {shape} | {' | '.join(map(str, row))} |")
    lines += ["", "| refused because | designs | for example |", "|---|---|---|"]
    lines += _reasons(by_kind["refused"])
    lines += ["", "| no passage because | designs | for example |", "|---|---|---|", *_reasons(by_kind["blade only"])]
    lines += ["", "| no wheel because | designs | for example |", "|---|---|---|", *_reasons(by_kind["no wheel"])]
    bad = [outcome for kind in ("failed", "crashed", "hung") for outcome in by_kind[kind]]
    if bad:
        lines += ["", "## Failures", ""]
        lines += [f"* seed {o.seed} {o.kind}: {o.message.strip().splitlines()[-1]}" for o in bad]
    return "\n".join(lines) + "\n"


def _reasons(refused):
    reasons = Counter(reason_of(outcome.message) for outcome in refused)
    for reason, count in reasons.most_common():
        example = next(outcome for outcome in refused if reason_of(outcome.message) == reason)
        yield f"| {reason} | {count} | seed {example.seed}: {example.message} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=np.inf, help="begin no design later than this")
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--record", type=Path, help="Markdown file for the result")
    parser.add_argument("--of", choices=list(DRAWN), default="unified", help="what is drawn")
    parser.add_argument("--show", action="store_true", help="print each design as its file holds it")
    given = parser.parse_args()
    if given.show:
        _show(range(given.seed, given.seed + given.count), given.of)
    found = []
    seeds = range(given.seed, given.seed + given.count)
    until = time.monotonic() + 60.0 * given.minutes
    for outcome in outcomes(seeds, given.jobs, samples=given.samples, of=given.of, until=until):
        found.append(outcome)
        if outcome.kind != "refused" or given.show:
            print(f"seed {outcome.seed}: {outcome.kind} in {outcome.seconds:.1f} s: {outcome.message}", flush=True)
    # the processes end in any order
    text = report(sorted(found, key=lambda outcome: outcome.seed), f"python {' '.join(sys.argv)}")
    print(text)
    if given.record:
        given.record.write_text(text, encoding="utf-8")
    return 1 if any(outcome.kind not in FINE for outcome in found) else 0


def _show(seeds, of):
    from bladewright.errors import DesignError
    from bladewright.files.writing import write_design

    for seed in seeds:
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "design.toml"
            try:
                write_design(DRAWN[of].random_design(seed), path)
                print(path.read_text())
            except DesignError as error:
                print(f"seed {seed}: {error}")


if __name__ == "__main__":
    sys.exit(main())
