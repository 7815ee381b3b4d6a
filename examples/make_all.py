"""Remake exports/: the STEP file, the round-trip report and the picture of every example.

python examples/make_all.py [NAME]...
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from _common import EXPORTS, example
from PIL import Image

import bladewright as bw

HERE = Path(__file__).parent
NAMES = sorted(path.stem for path in HERE.glob("*.py") if path.stem not in {"_common", "make_all"})
WIDTH = 1600
"""of a picture in exports/ [pixels]"""


def remade(name):
    """Run an example's script and keep its STEP file, its report and a smaller picture."""
    with tempfile.TemporaryDirectory() as directory:
        made = Path(directory)
        run = subprocess.run([sys.executable, HERE / f"{name}.py", made], check=True, capture_output=True, text=True)
        EXPORTS.mkdir(exist_ok=True)
        for suffix in (".step", ".roundtrip.json"):
            (EXPORTS / f"{name}{suffix}").write_bytes((made / f"{name}{suffix}").read_bytes())
        with Image.open(made / f"{name}.png") as picture:
            size = (WIDTH, round(picture.height * WIDTH / picture.width))
            small = picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)
            # a palette that covers the colours of thin lines too, at a quarter of the bytes
            few = small.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
            few.save(EXPORTS / f"{name}.png", optimize=True)
    return run.stdout.strip().splitlines()[-1]


def listing(found):
    """The text of exports/README.md; `found` holds what each script measured, by name."""
    lines = [
        "# What the examples make",
        "",
        "`python examples/make_all.py` makes all of this again: for each example the STEP file (AP242, mm), the",
        "report of its round trip and a picture of what its design builds. The scripts write IGES files too. That of",
        "`marine-propeller` is a wheel: three blades with their fillets and their hub as one solid.",
        "",
        "| example | measured by its script | side faces off by at most | volume | STEP |",
        "|---|---|---|---|---|",
    ]
    for name in NAMES:
        trip = json.loads((EXPORTS / f"{name}.roundtrip.json").read_text(encoding="utf-8"))
        sides = max(face["max_deviation_mm"] for face in trip["faces"] if face["name"].endswith(("upper", "lower")))
        volume = trip["volume_mm3"]
        size = (EXPORTS / f"{name}.step").stat().st_size / 1024
        lines.append(
            f"| [{name}]({name}.png): {example(name).description} | {found[name]} | {sides:.1e} mm "
            f"| {volume['cad']:.6g} mm³, {volume['relative_error']:.0e} | {size:.0f} kB |"
        )
    lines += ["", f"Made by bladewright {bw.__version__}.", ""]
    return "\n".join(lines)


def main(names):
    kept = EXPORTS / "measured.json"
    found = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    for name in names:
        found[name] = remade(name)
        print(f"{name}: {found[name]}", flush=True)
    kept.write_text(json.dumps({name: found[name] for name in NAMES}, indent=2) + "\n", encoding="utf-8")
    (EXPORTS / "README.md").write_text(listing(found), encoding="utf-8")
    total = sum(path.stat().st_size for path in EXPORTS.iterdir())
    print(f"exports/: {total / 1e6:.1f} MB")
    assert total < 16e6


if __name__ == "__main__":
    main(sys.argv[1:] or NAMES)
