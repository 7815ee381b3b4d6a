"""What every example does besides its measurement: read its design, build it, write CAD files and draw it."""

import json
import sys
from importlib import resources
from pathlib import Path

import bladewright as bw
from bladewright import cad, views

EXPORTS = Path(__file__).parents[1] / "exports"


def example(name):
    """The built-in design of that name; `bladewright new NAME` writes its file to start from."""
    with resources.as_file(resources.files("bladewright") / "examples" / f"{name}.toml") as path:
        return bw.read_design(path)


def export(design, body):
    """Write verified STEP and IGES files of a blade or a wheel, and a picture of what the design builds.

    They go to the directory that is the script's argument, or to exports/; NAME.roundtrip.json is what was measured.
    """
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else EXPORTS
    directory.mkdir(parents=True, exist_ok=True)
    for suffix in ("igs", "step"):
        trip = cad.write(body, directory / f"{design.name}.{suffix}")
        print(trip)
        assert trip.passed, trip.failures
    report = json.dumps(trip.to_dict(), indent=2)
    (directory / f"{design.name}.roundtrip.json").write_text(report + "\n", encoding="utf-8")
    views.picture(design if design.dimension == 2 else body, directory / f"{design.name}.png")
