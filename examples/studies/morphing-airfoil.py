"""NACA 23012 morphed for a wind tunnel: its edges turned by XFOIL, then its skin by NeuralFoil, confirmed by XFOIL.

The conditions are those of Tortora et al. 2023, section 4.3, as its table 16 shows them: coordinates in metres with a
chord of 0.245, XFOIL's reference length 1, a Reynolds number of 2.0394e6 per metre, alpha 4 deg. Coefficients are by
1 m, so that cl is proportional to the circulation; the efficiency is cl / cd. XFOIL, NeuralFoil and pymoo are needed.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import bladewright as bw

REYNOLDS, ALPHA, CHORD = 2.0394e6, 4.0, 0.245
PAPER = {"initial": (0.1586, 0.00252), "edges": (0.329, 0.00442), "skin": (0.330, 0.00442)}
"""cl and cd of its tables 16 and 17"""
BAND = 0.005
"""how far the skin may move, of the chord"""
SAME_LIFT = 0.005
"""by how much of it the skin may change the lift, as a polar of NeuralFoil has it"""
EDGES = {"section.morph.leading_edge": (-20.0, 30.0), "section.morph.trailing_edge": (-50.0, 20.0)}
"""deg, as in the paper; a negative trailing edge is a flap down"""
SKIN = {
    **{f"section.*.{name}.skin.ordinates[0]": (-0.01, 0.01) for name in ("leading_edge", "trailing_edge")},
    **{f"section.*.{name}.skin.abscissas[0]": (-0.03, 0.03) for name in ("leading_edge", "trailing_edge")},
    "section.*.leading_edge.skin.*_scale": (-0.1, 0.1),
    "section.*.trailing_edge.skin.front_scale": (-0.2, 0.2),
}
"""changes of inner control points and scale factors of the segments 1, 3, 4 and 6: 14 variables"""


def airfoil():
    """NACA 23012 by its formula, matched with 22 parameters, in its wind tunnel."""
    formula = bw.Naca5(thickness=0.12, design_lift=0.3, camber_position=0.15, trailing_edge="blunt")
    section = bw.ProfileSection(name="naca-23012", length_unit="m", chord=1.0, section=formula).build()
    u = (1.0 - np.cos(np.linspace(0.0, np.pi, 71))) / 2.0
    points = np.concatenate([section.curves["upper"](u[::-1]), section.curves["lower"](u[1:])])
    found = bw.fit(points, family="segmented", length_unit="m")
    print(f"NACA 23012 within {found.maximum:.1e} of its chord, {len(found.design.parameters())} parameters")
    return found.design.changed(
        {
            "name": "naca-23012",
            "chord": CHORD * found.design.chord,
            "tolerance": 1e-5,  # of surfaces that XFOIL cannot tell from closer ones
            "section.morph": bw.Morph(),
        }
    )


def with_skin(design):
    """The same airfoil with skins that may move within their bands."""
    found = {}
    for name in ("upper", "lower"):
        side = getattr(design.section, name)
        for segment, behind in (("leading_edge", {"rear_scale": 0.0}), ("trailing_edge", {})):
            skin = bw.Skin(inner=BAND, outer=BAND, abscissas=(0.0,), ordinates=(0.0,), front_scale=0.0, **behind)
            found[f"section.{name}.{segment}"] = replace(getattr(side, segment), skin=skin)
    return design.changed(found)


class Flow:
    """The figures of a section by XFOIL."""

    def __init__(self, turn):
        self.turn = turn

    def __call__(self, section):
        polar = bw.polar(section, REYNOLDS, ALPHA - self.turn, reference_length=1.0)
        cl, cd, cm = (float(each[0]) for each in (polar.cl, polar.cd, polar.cm))
        return {"cl": cl, "cd": cd, "moment": abs(cm), "efficiency": cl / cd}


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("directory", nargs="?", type=Path, default=Path.cwd())
    arguments.add_argument("--edges", type=int, nargs=2, default=(70, 10), help="population and generations")
    arguments.add_argument("--skin", type=int, nargs=2, default=(600, 20), help="population and generations")
    arguments.add_argument("--jobs", type=int)
    given = arguments.parse_args()
    given.directory.mkdir(parents=True, exist_ok=True)

    start = airfoil()
    turn = start.section.stagger_angle
    xfoil = Flow(turn)
    initial = xfoil(start.build())
    print(f"initial: cl {initial['cl']:.4f}, cd {initial['cd']:.5f}, paper {PAPER['initial']}")

    options = {"jobs": given.jobs, "time_limit": 30.0}
    turned = bw.optimise(
        start,
        EDGES,
        [{"quantity": xfoil, "figure": name, "maximise": name == "cl"} for name in ("cl", "cd", "moment")],
        population=given.edges[0],
        generations=given.edges[1],
        manifest=given.directory / "edges.jsonl",
        **options,
    )
    print(turned)
    efficiency = turned.best.figures["cl"] / turned.best.figures["cd"]
    chosen = turned.members[int(np.argmax(efficiency))]
    edges = turned.design(chosen)
    base = xfoil(edges.build())
    print(f"edges: {edges.section.morph}: cl {base['cl']:.4f}, efficiency {base['efficiency']:.2f}")

    skinned = bw.optimise(
        with_skin(edges),
        {name: {"lower": low, "upper": high, "offset": True} for name, (low, high) in SKIN.items()},
        # its moment is nose down
        [{"quantity": f"tunnel.{name}", "maximise": True} for name in ("lift_to_drag", "cm")],
        [{"quantity": "tunnel.cl", "lower": 1.0 - SAME_LIFT, "upper": 1.0 + SAME_LIFT, "relative": True}],
        polars={
            "tunnel": bw.OperatingPoint(
                reynolds=REYNOLDS, alpha=ALPHA - turn, reference_length=1.0, solver="neuralfoil"
            )
        },
        population=given.skin[0],
        generations=given.skin[1],
        manifest=given.directory / "skin.jsonl",
        **options,
    )
    print(skinned)
    # XFOIL's word on the front by NeuralFoil
    order = np.argsort(-skinned.best.figures["tunnel.lift_to_drag"])[:30]
    confirmed = [(number, xfoil(skinned.design(number).build())) for number in (skinned.members[i] for i in order)]
    number, best = max(confirmed, key=lambda each: each[1]["efficiency"])
    print(f"skin: run {number}: cl {best['cl']:.4f}, efficiency {best['efficiency']:.2f} by XFOIL")
    draw(turned, [each for _, each in confirmed], initial, given.directory / "morphing-airfoil.png")

    assert abs(initial["cl"] / PAPER["initial"][0] - 1.0) < 0.01
    assert abs(initial["cd"] / PAPER["initial"][1] - 1.0) < 0.03
    assert base["efficiency"] > 74.39 or given.edges[0] < 70
    assert best["efficiency"] > 78.26 or given.skin[0] < 600


def draw(turned, skinned, initial, path):
    """Efficiency over cl: all turned airfoils, the front, the skins, and the paper's points."""
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    every, best = (each.figures["cl"] / each.figures["cd"] for each in (turned.runs, turned.best))
    axes.plot(turned.runs.figures["cl"], every, ".", color="#8a97a3", markersize=3.0, label="edges turned, XFOIL")
    axes.plot(turned.best.figures["cl"], best, "o", color="#1f6f9f", markersize=4.0, label="of these Pareto optimal")
    skins = np.array([[each["cl"], each["efficiency"]] for each in skinned])
    axes.plot(*skins.T, "D", color="#3a8f5c", markersize=4.0, label="skin moved, XFOIL")
    axes.plot(initial["cl"], initial["efficiency"], "*", color="#22303c", markersize=12.0, label="NACA 23012, XFOIL")
    for name, (cl, cd) in PAPER.items():
        axes.plot(cl, cl / cd, "x", color="#b23a48", markersize=9.0, markeredgewidth=2.0)
        above = 6.0 if name == "skin" else -12.0
        axes.annotate(f"paper, {name}", (cl, cl / cd), (8.0, above), textcoords="offset points", color="#b23a48")
    axes.set_xlim(0.0, 0.5)
    axes.set_ylim(30.0, None)
    axes.set_xlabel("cl by 1 m")
    axes.set_ylabel("efficiency cl / cd")
    axes.grid(color="#e4e9ee")
    axes.legend(frameon=False, loc="upper left")
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    main()
