"""Fillets of every 3D example: radii of 0.3 to 6 % of the chord on each wall, proven by a round trip or refused.

A refusal must name the largest radius: 0.95 of it is built and 1.05 of it is refused again.

    python design/fillets.py --jobs 2 --record design/fillets.md
    python design/fillets.py nasa-rotor-67 --wall hub
"""

import argparse
import multiprocessing
import re
import sys
import tempfile
import time
from collections import Counter
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import fillet_balls
import numpy as np

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.fillet import Fillet

SHARES = (0.003, 0.006, 0.012, 0.025, 0.04, 0.06)
"""radii over the chord"""
NAMED = re.compile(r"largest that holds is ([\d.e+-]+) ")
PLACE = re.compile(
    r" (at|near) (u = [\d.]+( of the \w+ side)?|the ((upper|lower) corner of the )?(leading|trailing) edge)"
)
"""where a fillet does not hold"""
WORDS = ("proven", "NOT PROVEN", "refused", "BROKEN PROMISE")


class Row(NamedTuple):
    """What became of one fillet."""

    example: str
    wall: str
    share: float
    radius: float
    what: str
    """one of WORDS"""
    told: str
    seconds: float = 0.0
    added: float = 0.0

    def __str__(self) -> str:
        figures = f"{self.seconds:.2f} | {self.added:.5g}" if self.what == "proven" else "|"
        head = f"| {self.example} | {self.wall} | {100 * self.share:g} | {self.radius:.3g}"
        return f"{head} | {self.what} | {self.told} | {figures} |"


def built(design, wall: str, radius: float):
    start = time.process_time()
    try:
        blade = design.changed(f"{wall}_fillet", Fillet(radius=radius)).build()
    except bw.DesignError as error:
        return None, str(error), time.process_time() - start
    return blade, "", time.process_time() - start


def row(design, plain, plain_time: float, wall: str, share: float, folder: Path) -> Row:
    """Build one fillet and prove it, or hold its refusal to what it names."""
    radius = share * plain.chord / design.metre
    blade, refusal, seconds = built(design, wall, radius)
    head = (design.name, wall, share, radius)
    if blade is None:
        told, named = refusal.split(": ", 1)[-1], NAMED.search(refusal)
        if not named:
            return Row(*head, "refused", told)
        below, wrong, _ = built(design, wall, 0.95 * float(named[1]))
        above = built(design, wall, 1.05 * float(named[1]))[0]
        if below is None or above is not None:
            broken = f"0.95 of it: {wrong}" if below is None else "1.05 of it is built"
            return Row(*head, "BROKEN PROMISE", f"{told}; {broken}")
        return Row(*head, "refused", f"{told}; 0.95 built, 1.05 refused")
    trip = cad.write(blade, folder / "blade.step")
    added = (blade.properties.volume - plain.properties.volume) * 1e9
    nets = [blade.surfaces[name].control_points for name in ("upper", f"{wall}_strip_upper", f"{wall}_fillet_upper")]
    poles = ", ".join(f"{len(net)} x {len(net[0])}" for net in nets)
    if not trip.passed:
        return Row(*head, "NOT PROVEN", f"{poles}: {'; '.join(trip.failures)}")
    return Row(*head, "proven", poles, seconds - plain_time, added)


def rows_of(case: tuple[str, str]) -> list[Row]:
    """All radii at one wall of an example."""
    name, wall = case
    design = bw.read_design(files("bladewright") / "examples" / name)
    design = design.changed({"hub_fillet": None, "shroud_fillet": None})
    start = time.process_time()
    plain = design.build()
    plain_time = time.process_time() - start
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for share in SHARES:
            found.append(row(design, plain, plain_time, wall, share, Path(folder)))
            sys.stdout.write(f"{found[-1]}\n")
            sys.stdout.flush()
    return found


def cases(names: list[str], walls: list[str]) -> list[tuple[str, str]]:
    """Walls of the examples."""
    found = []
    for path in sorted((files("bladewright") / "examples").iterdir()):
        design = bw.read_design(path) if path.name.endswith(".toml") else None
        if design is not None and design.dimension == 3 and (not names or design.name in names):
            found += [(path.name, wall) for wall in design.ends if wall in walls]
    return found


def text(rows: list[Row], balls: list[str], command: str) -> str:
    """The record."""
    counts = Counter(each.what for each in rows)
    reasons = Counter(reason(each) for each in rows if each.what == "refused")
    ends = sum(each.what == "refused" and bool(NAMED.search(each.told)) for each in rows)
    seconds = np.quantile([each.seconds for each in rows if each.what == "proven"], (0.5, 0.95, 1.0))
    found = ", ".join(f"{counts[word]} {word}" for word in WORDS)
    return "\n".join(
        [
            "# Fillets of every example",
            "",
            f"`{command}`: {len(rows)} fillets, {found}.",
            "Each that is built is written to STEP, reopened and measured.",
            f"{ends} refusals name the largest radius that holds, of which 0.95 is built and 1.05 refused.",
            "",
            "Seconds are of processor time, beside the build without a fillet:",
            "{:.2f} in the median, {:.2f} in 95 % of the fillets, {:.2f} at most.".format(*seconds),
            "",
            "The fillet of a straight blade on a flat wall has the volume of Pappus within 1e-6",
            "(tests/blade/test_fillets.py); OpenCASCADE's fillets are beside ours in kernel_fillets.md.",
            "",
            "| refused because | fillets |",
            "|---|---|",
            *(f"| {why} | {count} |" for why, count in reasons.most_common()),
            "",
            "## Read back from STEP, beside the rolling ball",
            "",
            *balls,
            "",
            "## Every fillet",
            "",
            "| example | wall | % of the chord | radius | | poles of side, strip and fillet | s added | mm^3 added |",
            "|---|---|---|---|---|---|---|---|",
            *map(str, rows),
            "",
        ]
    )


def reason(refused: Row) -> str:
    """Why a fillet was refused, without the place and the figures."""
    why = PLACE.sub("", " " + refused.told.split(";")[0]).strip()
    why = re.sub(r"\d[\d.e+-]*", "...", why.replace(refused.wall, "wall"))
    return f"{why}; no smaller one holds" if "no smaller" in refused.told else why


def main() -> None:
    """Measure all examples, or those named, and write the record as they come."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="only these examples")
    parser.add_argument("--wall", action="append", choices=["hub", "shroud"], help="only this wall")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--record", type=Path, help="write the figures to this file")
    options = parser.parse_args()
    found: list[Row] = []
    with multiprocessing.get_context("spawn").Pool(options.jobs) as pool:
        for rows in pool.imap_unordered(rows_of, cases(options.names, options.wall or ["hub", "shroud"])):
            found = sorted([*found, *rows])
    if options.record:
        options.record.write_text(text(found, fillet_balls.table(), "python " + " ".join(sys.argv)))


if __name__ == "__main__":
    main()
