"""Fillets at the hub by OpenCASCADE beside the native ones: which it makes, their volume, and how far off the ball.

The extended plain blade is fused to a block below its hub, whose upper face is the exact hub, and the edges between
them are given to BRepFilletAPI_MakeFillet. Each case runs in a process of its own, at most a minute.

    python design/kernel_fillets.py            writes design/kernel_fillets.md
    python design/kernel_fillets.py aachen-stator 0.012
"""

import subprocess
import sys
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Transform,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol
from OCP.BRepTools import BRepTools
from OCP.BRepTopAdaptor import BRepTopAdaptor_FClass2d
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Pnt2d, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_EDGE, TopAbs_OUT
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from scipy.spatial import cKDTree

import bladewright as bw
from bladewright.blade.design.fillet import Fillet
from bladewright.cad.conversion import space_curve
from bladewright.cad.solids import occ_solid
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.domain import reversed as run_back
from bladewright.nurbs.revolution import segment

EXAMPLES = (
    "aachen-stator",
    "booster-stator",
    "centrifugal-impeller",
    "core-rotor",
    "fan-rotor",
    "mixed-flow-pump",
    "nasa-rotor-67",
    "propeller",
    "pump-inducer",
    "radial-turbine",
    "vki-ls89",
)
SHARES = (0.003, 0.006, 0.012, 0.025)
"""radii over the chord"""
AXIS = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(-1.0, 0.0, 0.0))
"""theta grows from z towards y"""
DEPTH = 0.12
"""of the block below the hub, in chords"""
MM = 1e3


def volume(shape) -> float:
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, 1e-7, OnlyClosed=False, SkipShared=False)
    return found.Mass()


def hub_block(blade, outline, radius: float):
    """What lies below the hub around the blade [mm]."""
    meridian, _ = blade.end_wall("hub")
    x, height = meridian.control_points.T
    line = Curve(control_points=np.stack([x, 0.0 * x, height], -1), knots=meridian.knots, degree=meridian.degree)
    start, end = (line(t) * MM for t in meridian.domain)
    side = blade.sides[0]
    middle, grows = side(0.5, 0.0), side(0.5, 0.2) - side(0.5, 0.0)
    revolved = blade.exact.mapping.revolved
    radial = np.array([0.0, middle[1], middle[2]]) / np.hypot(*middle[1:]) if revolved else np.array([0.0, 0.0, 1.0])
    up = np.array([grows[0], 0.0, grows @ radial])
    along = end - start
    down = np.array([along[2], 0.0, -along[0]])
    down *= -np.sign(down @ up) * DEPTH * MM * float(blade.chord) / np.linalg.norm(along)
    below = replace(line, control_points=line.control_points + down / MM)
    wire = BRepBuilderAPI_MakeWire()
    for curve in (line, segment(line(line.domain[1]), below(line.domain[1])), run_back(below)):
        wire.Add(BRepBuilderAPI_MakeEdge(space_curve(curve)).Edge())
    wire.Add(BRepBuilderAPI_MakeEdge(space_curve(segment(below(line.domain[0]), line(line.domain[0])))).Edge())
    face, place = BRepBuilderAPI_MakeFace(wire.Wire()).Face(), gp_Trsf()
    if not revolved:
        low, high = outline[:, 1].min() - 20.0 * radius, outline[:, 1].max() + 20.0 * radius
        place.SetTranslation(gp_Vec(0.0, float(low), 0.0))
        return BRepPrimAPI_MakePrism(
            BRepBuilderAPI_Transform(face, place, theCopyGeom=True).Shape(), gp_Vec(0.0, float(high - low), 0.0)
        ).Shape()
    theta = np.unwrap(np.arctan2(outline[:, 1], outline[:, 2]))
    margin = 0.02 + 3.0 * radius / np.mean(np.hypot(outline[:, 1], outline[:, 2]))
    place.SetRotation(AXIS, float(theta.min() - margin))
    turned = BRepBuilderAPI_Transform(face, place, theCopyGeom=True).Shape()
    return BRepPrimAPI_MakeRevol(turned, AXIS, float(np.ptp(theta) + 2.0 * margin)).Shape()


def edges_along(shape, outline, near: float) -> list:
    """The edges of a shape that run along an outline [mm]."""
    found, explorer = {}, TopExp_Explorer(shape, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge_s(explorer.Current())
        explorer.Next()
        curve = BRepAdaptor_Curve(edge)
        values = [curve.Value(s) for s in np.linspace(curve.FirstParameter(), curve.LastParameter(), 9).tolist()]
        points = np.array([(p.X(), p.Y(), p.Z()) for p in values])
        if cKDTree(outline).query(points)[0].max() < near:
            found[hash(edge)] = edge
    return list(found.values())


def off_ball(fillet, edges, native, radius: float) -> tuple[float, float]:
    """Largest and median distance of OpenCASCADE's fillet from the ball, of the radius.

    The ball's centres are a radius above the native feet along the wall's normal.
    """
    u, centres = np.linspace(0.0, 1.0, 3001), []
    for name in ("upper", "lower"):
        face = native.surfaces[f"hub_fillet_{name}"]
        normal = face.normal(u, 0.0) * -native.orientations["hub"]
        outward = face(u, 0.5) - face(u, 0.0)
        normal = normal * np.sign(np.sum(normal * outward, axis=-1, keepdims=True))
        centres.append(MM * face(u, 0.0) + radius * normal)
    tree, points = cKDTree(np.concatenate(centres)), []
    for edge in edges:
        for shape in fillet.Generated(edge):
            face = TopoDS.Face_s(shape)
            surface, inside = BRepAdaptor_Surface(face), BRepTopAdaptor_FClass2d(face, 1e-9)
            u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
            for place in np.stack(np.meshgrid(np.linspace(u0, u1, 81), np.linspace(v0, v1, 41)), -1).reshape(-1, 2):
                if inside.Perform(gp_Pnt2d(*place.tolist())) != TopAbs_OUT:
                    point = surface.Value(*place.tolist())
                    points.append((point.X(), point.Y(), point.Z()))
    off = np.abs(tree.query(np.array(points))[0] / radius - 1.0)
    return float(off.max()), float(np.median(off))


def row(name: str, share: float) -> str:
    design = bw.read_design(files("bladewright") / "examples" / f"{name}.toml").plain
    blade = design.build()
    radius = share * MM * float(blade.chord)
    native = design.changed("hub_fillet", Fillet(radius=radius / MM / design.metre)).build()
    added = (native.properties.volume - blade.properties.volume) * MM**3
    head = f"| {name} | {100 * share:g} | {radius:.3g} | {added:.5g} |"
    outline = MM * np.concatenate([curve(np.linspace(0.0, 1.0, 200)) for curve in blade.end_outline("hub")])
    fused = BRepAlgoAPI_Fuse(occ_solid(blade.extended(0.15)).solid, hub_block(blade, outline, radius)).Shape()
    fillet = BRepFilletAPI_MakeFillet(fused)
    edges = edges_along(fused, outline, 0.01 * MM * float(blade.chord))
    for edge in edges:
        fillet.Add(radius, edge)
    try:
        fillet.Build()
    except RuntimeError as error:
        return f"{head} raised {type(error).__name__} | | | |"
    if not fillet.IsDone():
        return f"{head} not done | | | |"
    word = "valid" if BRepCheck_Analyzer(fillet.Shape()).IsValid() else "invalid"
    other = volume(fillet.Shape()) - volume(fused)
    largest, median = off_ball(fillet, edges, native, radius)
    return f"{head} {word} | {other / added - 1.0:.1e} | {largest:.1e} | {median:.1e} |"


def alone(name: str, share: float) -> str:
    """A row by a process of its own."""
    command = [sys.executable, __file__, name, str(share)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60.0, check=False)
    except subprocess.TimeoutExpired:
        return f"| {name} | {100 * share:g} | | | no end in a minute | | | |"
    return done.stdout.strip() or f"| {name} | {100 * share:g} | | | {done.stderr.strip().splitlines()[-1]} | | | |"


def main() -> None:
    rows = []
    for name in EXAMPLES:
        for share in SHARES:
            rows.append(alone(name, share))
            print(rows[-1], flush=True)
    valid = sum("| valid |" in each for each in rows)
    text = [
        "# OpenCASCADE's fillets beside the native ones",
        "",
        (
            f"`python design/kernel_fillets.py`, OpenCASCADE 7.9: of {len(rows)} fillets at the hub it makes {valid} "
            "valid ones, of which the volume added is compared with the native one's. Where the two differ by more "
            "than 1e-3, its faces leave the ball by the share of the radius in the last columns (largest, median of "
            "the faces' points): around edges that are sharper than the ball it fills the gap between the fillets of "
            "both sides by a face that is no envelope of the ball, and too hollow."
        ),
        "",
        "| example | % of the chord | radius [mm] | native [mm^3] | OpenCASCADE | its volume | off the ball | median |",
        "|---|---|---|---|---|---|---|---|",
        *rows,
    ]
    Path(__file__).with_suffix(".md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(row(sys.argv[1], float(sys.argv[2])))
    else:
        main()
