"""The tables of docs/verify.md: the worst figure of a blade and of a round trip over all built-in examples.

python design/proof.py
"""

import tempfile
from pathlib import Path

import bladewright as bw
from bladewright import cad
from bladewright.files.examples import example_text, examples
from bladewright.section.unified import UnifiedSection

FIGURES = (
    "metal_angle_at_walls",
    "metal_angle_between",
    "edge_radius",
    "edge_tangent_planes",
    "edge_curvatures",
    "surface",
    "walls",
    "sections",
)


def figures(trip):
    """Side and end deviation [mm], gap [mm], side area and volume of one round trip."""
    found = trip.to_dict()
    sides = [face for face in found["faces"] if face["name"] in {"upper", "lower"}]
    ends = [face for face in found["faces"] if face["name"] not in {"upper", "lower"}]
    return {
        "side": max(face["max_deviation_mm"] for face in sides),
        "end": max(face["max_deviation_mm"] for face in ends),
        "gap": found["edges"]["max_gap_mm"],
        "area": max(face["area_mm2"]["relative_error"] for face in sides),
        "volume": found["volume_mm3"]["relative_error"],
    }


def main():
    """Measure every example and print the worst of each figure."""
    worst = dict.fromkeys(FIGURES, (0.0, ""))
    files = {kind: {} for kind in ("step", "igs")}
    with tempfile.TemporaryDirectory() as directory:
        for name in examples():
            path = Path(directory) / f"{name}.toml"
            path.write_text(example_text(name), encoding="utf-8")
            design = bw.read_design(path)
            blade = (bw.prismatic(design) if isinstance(design, UnifiedSection) else design).build()
            assert blade.conformance.kept, name
            for figure in FIGURES:
                value = getattr(blade.conformance, figure)
                # a family without metal angles has no such figure
                worst[figure] = max(worst[figure], (0.0 if value is None else value, name))
            for kind, found in files.items():
                trip = cad.write(blade, Path(directory) / f"{name}.{kind}")
                assert trip.passed, (name, trip.failures)
                for what, value in figures(trip).items():
                    found[what] = max(found.get(what, (0.0, "")), (value, name))
    for figure, (value, name) in worst.items():
        print(f"{figure:22} {value:.1e}   {name}")
    for kind, found in files.items():
        for what, (value, name) in found.items():
            print(f"{kind:4} {what:17} {value:.1e}   {name}")


if __name__ == "__main__":
    main()
