"""Fillets of every 3D example: radii of 0.3 to 6 % of the chord on each wall, proven by a round trip or refused.

A refusal must name the largest radius: 0.95 of it is built and 1.05 of it is refused again.

    python design/fillets.py [example ...]      writes design/fillets.md when all examples are run
"""

import re
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path

import bladewright as bw
from bladewright import cad
from bladewright.blade.design.fillet import Fillet

SHARES = (0.003, 0.006, 0.012, 0.025, 0.04, 0.06)
"""radii over the chord"""
PROVEN = (0.003, 0.012, 0.06)
"""radii whose solid is written and compared; of the others it is built"""
NAMED = re.compile(r"largest that holds is ([\d.e+-]+) ")


def built(design, wall: str, radius: float):
    start = time.process_time()
    try:
        blade = design.changed(f"{wall}_fillet", Fillet(radius=radius)).build()
    except bw.DesignError as error:
        return None, str(error), time.process_time() - start
    return blade, "", time.process_time() - start


def line(design, plain, plain_time: float, wall: str, share: float, folder: Path) -> str:
    radius = share * plain.chord / design.metre
    blade, refusal, seconds = built(design, wall, radius)
    head = f"| {design.name} | {wall} | {100 * share:g} | {radius:.3g} "
    if blade is None:
        named = NAMED.search(refusal)
        if not named:
            return f"{head}| refused | {refusal.split(': ', 1)[-1]} | | |"
        largest = float(named[1])
        below, above = built(design, wall, 0.95 * largest)[0], built(design, wall, 1.05 * largest)[0]
        proof = "0.95 built, 1.05 refused" if below and not above else "BROKEN PROMISE"
        return f"{head}| refused | {refusal.split(': ', 1)[-1]}; {proof} | | |"
    what = "built"
    if share in PROVEN:
        what = "proven" if cad.write(blade, folder / "blade.step").passed else "NOT PROVEN"
    added = (blade.properties.volume - plain.properties.volume) * 1e9
    nets = [blade.surfaces[name].control_points for name in ("upper", f"{wall}_strip_upper", f"{wall}_fillet_upper")]
    poles = ", ".join(f"{len(net)} x {len(net[0])}" for net in nets)
    return f"{head}| {what} | {poles} | {seconds - plain_time:.2f} | {added:.5g} |"


def main(names: list[str]) -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted((files("bladewright") / "examples").iterdir()):
            design = bw.read_design(path) if path.name.endswith(".toml") else None
            if design is None or design.dimension != 3 or (names and design.name not in names):
                continue
            design = design.changed({"hub_fillet": None, "shroud_fillet": None})
            start = time.process_time()
            plain = design.build()
            plain_time = time.process_time() - start
            for wall in (name for name in design.ends if name != "tip"):
                for share in SHARES:
                    rows.append(line(design, plain, plain_time, wall, share, Path(folder)))
                    print(rows[-1], flush=True)
    if names:
        return
    counts = {word: sum(f"| {word} |" in row for row in rows) for word in ("proven", "built", "refused")}
    text = [
        "# Fillets of every example",
        "",
        (
            f"`python design/fillets.py`: {len(rows)} fillets, of which {counts['proven']} are proven by a round trip, "
            f"{counts['built']} built and {counts['refused']} refused."
        ),
        "",
        (
            "Seconds are of processor time, beside the build without a fillet. The fillet of a straight blade on a "
            "flat wall has the volume of Pappus within 1e-6 (tests/blade/test_fillets.py); OpenCASCADE's fillets are "
            "beside ours in kernel_fillets.md."
        ),
        "",
        "| example | wall | % of the chord | radius | | poles of side, strip and fillet | s added | mm^3 added |",
        "|---|---|---|---|---|---|---|---|",
        *rows,
    ]
    Path(__file__).with_suffix(".md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
