"""Broken input: what becomes of files cut short, with a line less or another value, and of designs with a wrong key.

    python design/bad_input.py --share 0.05 --seed 1
    python design/bad_input.py --of designs --like wedge --share 1
    python design/bad_input.py --of parts --share 1

The design files are those of the built-in examples; the files of T-Blade3 and ParaBlade are beside the repository. Each
broken one must be read, or refused in one paragraph that names it, within LIMIT seconds of processor time, without a
warning.
"""

import argparse
import copy
import re
import signal
import sys
import tempfile
import time
import tomllib
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bladewright.domain.sector import sector
from bladewright.errors import BladewrightError
from bladewright.files.examples import example_text, examples
from bladewright.files.parablade import import_parablade
from bladewright.files.reading import design_from
from bladewright.files.tblade3 import import_tblade3

DATA = Path(__file__).parents[2] / "shared" / "data"
LIMIT = 20.0
"""seconds of processor time; about twice what the slowest example takes"""
LONGEST = 1500
"""letters of a paragraph"""
VALUES: tuple[Any, ...] = (-1, 0, 1e9, 10**9, float("nan"), "text", [], [1.0], {}, True)
"""what takes the place of a key's value"""
WORDS = ("oops", "nan", "-1", "0", "1e9", "")
"""what takes the place of a number in a line"""
PARTS = """
density = 4430.0
disc = { outline = { points = [[-8, 94], [-8, 60], [80, 30], [97, 60], [97, 118.5]], radii = [3, 5, 3] } }
shroud_ring = { thickness = 4, upstream = 5, downstream = 5 }
[cut]
tip = { points = [[-200, 236], [200, 232]] }
trailing_edge = { x = 62 }
[hub_fillet]
kind = "curvature"
radius = { leading_edge = 1, upper = 1.5, trailing_edge = 1, lower = 1.5 }
[shroud_fillet]
kind = "ellipse"
on_blade = 1.0
on_wall = 0.8
"""
"""every part, in numbers that Rotor 67 takes"""
FINE = frozenset({"taken", "refused"})
_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?(?![\w.])")


@dataclass(frozen=True)
class Broken:
    """One input that was broken."""

    of: str
    change: str
    tried: Callable[[], Any]
    """takes it, or raises"""


@dataclass(frozen=True)
class Outcome:
    """What became of it."""

    kind: str
    """taken, refused, or what is wrong: unclear, crashed, slow"""
    said: str
    seconds: float


class SlowError(Exception):
    """It took longer than it may."""


def outcome_of(broken: Broken, limit: float = LIMIT) -> Outcome:
    """What becomes of a broken input."""
    start = time.process_time()

    def found(kind: str, said: str = "") -> Outcome:
        return Outcome(kind, said, time.process_time() - start)

    try:
        with limited(limit), warnings.catch_warnings():
            warnings.simplefilter("error")
            broken.tried()
    except BladewrightError as error:
        wrong = unclear(str(error), broken.of)
        return found("unclear", f"{wrong}: {error}") if wrong else found("refused", str(error))
    except SlowError:
        return found("slow", "".join(traceback.format_exc().splitlines(keepends=True)[-8:]))
    except Exception:  # noqa: BLE001
        return found("crashed", traceback.format_exc())
    return found("taken")


def unclear(message: str, name: str) -> str:
    """What is wrong with a refusal, or nothing."""
    if "\n" in message or not message.strip():
        return "not one paragraph"
    if name not in message:
        return "does not name its file"
    return f"has {len(message)} letters" if len(message) > LONGEST else ""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Stop what takes more processor time than that."""

    def stop(*_: object) -> None:
        raise SlowError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def broken_designs(name: str, text: str, *, build: bool = True) -> Iterator[Broken]:
    """A design file without each of its keys, and with each value of `VALUES` in the place of every value."""
    document = tomllib.loads(text)

    def tried(path: tuple[Any, ...], value: Any) -> Callable[[], Any]:
        def run() -> Any:
            design = design_from(_changed(document, path, value), name)
            try:
                return design.build() if build else None  # type: ignore[attr-defined]
            except BladewrightError as error:
                # the command line puts the file before it
                raise type(error)(f"{name}: {error}") from error

        return run

    for path in _paths(document):
        said = ".".join(map(str, path))
        for value in (_ABSENT, *VALUES):
            change = f"without {said}" if value is _ABSENT else f"{said} = {value!r}"
            yield Broken(name, change, tried(path, value))


def broken_parts(*, build: bool = True) -> Iterator[Broken]:
    """The rotor with every part that a design may have, each key of these left out or given another value.

    What is built is made a sector as well, which looks at disc and ring.
    """
    document = tomllib.loads(example_text("nasa-rotor-67")) | tomllib.loads(PARTS)

    def tried(path: tuple[Any, ...], value: Any) -> Callable[[], Any]:
        def run() -> Any:
            design = design_from(_changed(document, path, value), "parts")
            if not build:
                return None
            try:
                blade = design.build()  # type: ignore[attr-defined]
                return sector(blade) if blade.design.disc or blade.design.shroud_ring else blade
            except BladewrightError as error:
                raise type(error)(f"parts: {error}") from error

        return run

    for key, part in tomllib.loads(PARTS).items():
        for path in ((key,), *(_paths(part, (key,)) if isinstance(part, dict) else ())):
            said = ".".join(map(str, path))
            for value in (_ABSENT, *VALUES):
                change = f"without {said}" if value is _ABSENT else f"{said} = {value!r}"
                yield Broken("parts", change, tried(path, value))


def broken_files(
    files: dict[str, str], of: str, run: Callable[[dict[str, str]], Any], lines: range | None = None
) -> Iterator[Broken]:
    """Each of some files cut short after every line, without each line, and with other words for its numbers.

    `files` are texts by name; `lines` are the numbers of those that are tried, all where not given.
    """

    def tried(name: str, rows: list[str]) -> Callable[[], Any]:
        return lambda: run({**files, name: "\n".join(rows) + "\n"})

    for name, text in files.items():
        rows = text.splitlines()
        for i in lines or range(len(rows)):
            if i >= len(rows):
                break
            where = f"line {i + 1} of {name}"
            yield Broken(of, f"cut short before {where}", tried(name, rows[:i]))
            yield Broken(of, f"without {where}", tried(name, rows[:i] + rows[i + 1 :]))
            yield Broken(of, f"twice {where}", tried(name, rows[: i + 1] + rows[i:]))
            numbers = list(_NUMBER.finditer(rows[i]))
            for match in {m.start(): m for m in (numbers[0], numbers[-1])}.values() if numbers else ():
                for word in WORDS:
                    row = rows[i][: match.start()] + word + rows[i][match.end() :]
                    changed = tried(name, [*rows[:i], row, *rows[i + 1 :]])
                    yield Broken(of, f"'{word}' for {match[0]} in {where}", changed)


def imported(folder: Path, first: str, read: Callable[..., Any], *, build: bool = True) -> Callable[..., Any]:
    """A function that imports the file `first` among files that it writes into a folder, and builds its design."""

    def run(files: dict[str, str]) -> Any:
        for name, text in files.items():
            (folder / name).write_text(text)
        found = read(folder / first)
        try:
            return found.design.build() if build else None
        except BladewrightError as error:
            raise type(error)(f"{folder / first}: {error}") from error

    return run


_ABSENT = object()


def _paths(value: Any, before: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths to every value of a document; of long lists, to the first and the last entry."""
    if isinstance(value, dict):
        for key, each in value.items():
            yield (*before, key)
            yield from _paths(each, (*before, key))
    elif isinstance(value, list):
        for i in sorted({0, len(value) - 1}) if value else ():
            yield (*before, i)
            yield from _paths(value[i], (*before, i))


def _changed(document: dict[str, Any], path: tuple[Any, ...], value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(document)
    at: Any = changed
    for key in path[:-1]:
        at = at[key]
    if value is _ABSENT:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return changed


def _all(of: str, like: str, folder: Path, *, build: bool) -> Iterator[Broken]:
    if of in ("all", "designs"):
        for name in examples():
            if like in name:
                yield from broken_designs(f"{name}.toml", example_text(name), build=build)
    if of in ("all", "parts"):
        yield from broken_parts(build=build)
    if of in ("all", "tblade3"):
        for case in sorted((DATA / "tblade3").glob("*/input")):
            files = {path.name: path.read_text() for path in sorted(case.iterdir())}
            (first,) = (name for name in files if name.startswith("3dbgbinput"))
            if like in case.parent.name:
                run = imported(folder, first, import_tblade3, build=build)
                yield from broken_files(files, str(folder), run)
    if of in ("all", "parablade"):
        for path in sorted((DATA / "clouds").glob("*.cfg")):
            if like in path.name:
                run = imported(folder, path.name, import_parablade, build=build)
                yield from broken_files({path.name: path.read_text()}, path.name, run)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--of", choices=("all", "designs", "parts", "tblade3", "parablade"), default="all")
    parser.add_argument("--like", default="", help="part of the name of what is broken")
    parser.add_argument("--share", type=float, default=0.02, help="of all that can be broken")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--unbuilt", action="store_true", help="read only, and build nothing")
    parser.add_argument("--show", action="store_true", help="say what becomes of each")
    arguments = parser.parse_args()
    draw, counts, worst = np.random.default_rng(arguments.seed), Counter[str](), 0.0
    with tempfile.TemporaryDirectory() as name:
        for broken in _all(arguments.of, arguments.like, Path(name), build=not arguments.unbuilt):
            if draw.random() >= arguments.share:
                continue
            found = outcome_of(broken)
            counts[found.kind] += 1
            worst = max(worst, found.seconds)
            if arguments.show or found.kind not in FINE:
                print(f"{found.kind} in {found.seconds:.1f} s: {broken.of}, {broken.change}\n{found.said}", flush=True)
    print(", ".join(f"{count} {kind}" for kind, count in counts.most_common()), f"; at most {worst:.1f} s")
    return int(any(kind not in FINE for kind in counts))


if __name__ == "__main__":
    sys.exit(main())
