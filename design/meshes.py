"""Every built-in example as a mesh of the default size, from wall to wall and with a gap; see meshes.md.

python design/meshes.py [EXAMPLE ...]
"""

import sys
import tempfile
import time
from pathlib import Path

import bladewright as bw
from bladewright import cad, meshing
from bladewright.files.examples import example_text, examples
from bladewright.section.checks import UNITS
from bladewright.section.unified import UnifiedSection

STATORS = {"vki-ls89", "aachen-stator"}
"""get a gap at the hub, the others at the tip, where they have none of their own"""
GAP = 0.01
"""of the chord"""
HEAD = (
    "example", "gap", "tetrahedra", "expected", "worst minSICN", "1 % below", "worst gamma", "inverted",
    "off the surfaces [mm]", "periodic [pitch]", "volume", "s", "algorithms",
)  # fmt: skip


def designs(name, directory):
    """The design of an example from wall to wall, and the same with a gap, each with the name of its gap."""
    path = directory / f"{name}.toml"
    path.write_text(example_text(name), encoding="utf-8")
    design = bw.read_design(path)
    design = bw.prismatic(design) if isinstance(design, UnifiedSection) else design
    own = [gap for gap in ("tip", "hub") if getattr(design, f"{gap}_clearance") is not None]
    if own:
        return ("", design.changed(f"{own[0]}_clearance", None)), (own[0], design)
    gap = "hub" if name in STATORS else "tip"
    size = GAP * design.build().chord / UNITS[design.length_unit]
    return ("", design), (gap, design.changed(f"{gap}_clearance", size))


def row(name, gap, design, directory):
    """The figures of one mesh."""
    passage = bw.passage(design.build())
    step = directory / "passage.step"
    assert cad.write(passage, step, samples=1000).passed, name
    start = time.monotonic()
    report = meshing.mesh(step, directory / "passage.msh", passage=passage)
    seconds = time.monotonic() - start
    assert report.passed, report.failures
    return (
        name,
        gap or "-",
        f"{report.tetrahedra:,}",
        f"{report.expected:,}",
        f"{report.min_sicn.worst:.2f}",
        f"{report.min_sicn.percentile:.2f}",
        f"{report.gamma.worst:.2f}",
        report.inverted,
        f"{max(face.max_deviation_mm for face in report.faces):.0e}",
        f"{report.periodic_mismatch:.0e}",
        f"{report.volume_error:+.0e}",
        f"{seconds:.0f}",
        ", ".join(report.algorithms),
    )


def main():
    """Print a table of all examples, or of those that are named."""
    print("|", " | ".join(HEAD), "|")
    print("|---" * len(HEAD) + "|")
    for name in sys.argv[1:] or examples():
        with tempfile.TemporaryDirectory() as folder:
            directory = Path(folder)
            for gap, design in designs(name, directory):
                try:
                    cells = row(name, gap, design, directory)
                except bw.BladewrightError as error:
                    cells = (name, gap or "-", f"refused: {error}")
                print("|", " | ".join(map(str, cells)), "|", flush=True)


if __name__ == "__main__":
    main()
