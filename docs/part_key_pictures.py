"""What the keys of fillets, cuts and discs do: an impeller in the meridional plane, its fillet across and around."""

import tomllib

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from bladewright.domain.sector import sector
from bladewright.files.examples import example_text
from bladewright.files.reading import design_from
from bladewright.views.body import carried_lines
from bladewright.views.sections import foot_in_plane

SHOWN = "centrifugal-impeller"
"""the example that stands on the walls of all pictures, without its clearance"""
BLACK, RED, BLUE = "black", "tab:red", "tab:blue"
RADIUS = 2.0
"""of the fillet that is shown in black [mm]"""
FILLETS = {
    "kind": (
        {"radius": RADIUS},
        {"kind": "ellipse", "on_blade": 3.0, "on_wall": 2.0},
        {"kind": "curvature", "radius": RADIUS},
        "across the fillet: an arc (black), an ellipse of 3 by 2 mm (red), continuous curvature (blue)",
    ),
    "radius": (
        {"radius": RADIUS},
        {"radius": 3.0},
        {"radius": 1.0},
        "across the fillet: 2 mm (black), 3 mm (red) and 1 mm (blue)",
    ),
    "on_blade": (
        {"kind": "ellipse", "on_blade": RADIUS, "on_wall": RADIUS},
        {"kind": "ellipse", "on_blade": 3.0, "on_wall": RADIUS},
        {"kind": "ellipse", "on_blade": 1.2, "on_wall": RADIUS},
        "across the fillet: 2 mm (black), 3 mm (red) and 1.2 mm (blue), with 2 mm on the wall",
    ),
    "on_wall": (
        {"kind": "ellipse", "on_blade": RADIUS, "on_wall": RADIUS},
        {"kind": "ellipse", "on_blade": RADIUS, "on_wall": 3.0},
        {"kind": "ellipse", "on_blade": RADIUS, "on_wall": 1.2},
        "across the fillet: 2 mm (black), 3 mm (red) and 1.2 mm (blue), with 2 mm on the blade",
    ),
}
PLACES = {"leading_edge": 1.0, "upper": 1.5, "trailing_edge": 1.0, "lower": 1.5}
"""the radii of a fillet whose foot is drawn [mm]"""
ON_SIDES = {"suction_side": "lower", "pressure_side": "upper"}
CUTS = {
    "hub": {"points": [[-6, 28], [14, 28.4], [32, 32.6], [48, 42.8], [58, 59.3], [62.4, 81.6], [63, 107]]},
    "tip": {"points": [[-5, 54], [11, 54.6], [28, 57.1], [44, 63.4], [55, 74.3], [59.8, 88.8], [60, 104]]},
    "leading_edge": {"x": 8},
    "trailing_edge": {"radius": 90},
}
OUTLINE = [[-3, 24], [-3, 10], [76, 10], [76, 25], [69, 40], [69, 101], [66, 101]]
DISCS = {
    ("Disc", "outline"): (None, {"outline": {"points": OUTLINE}}, "the disc inside an outline (red)"),
    ("Disc", "thickness"): (
        {"thickness": 3.0},
        {"thickness": 5.0},
        "a thin rim of 3 mm (black) and 5 mm (red)",
    ),
    ("Disc", "upstream"): (
        {"thickness": 4.0, "upstream": 3.0},
        {"thickness": 4.0, "upstream": 9.0},
        "a thin rim that begins 3 mm (black) and 9 mm (red) upstream of the blade",
    ),
    ("Disc", "downstream"): (
        {"thickness": 4.0, "downstream": 1.0},
        {"thickness": 4.0, "downstream": 5.0},
        "a thin rim that ends 1 mm (black) and 5 mm (red) downstream of the blade",
    ),
    ("Outline", "points"): (
        {"outline": {"points": OUTLINE}},
        {"outline": {"points": [*OUTLINE[:2], [76, 16], *OUTLINE[3:]]}},
        "a disc (black), and the same with one point moved outwards by 6 mm (red)",
    ),
    ("Outline", "radii"): (
        {"outline": {"points": OUTLINE}},
        {"outline": {"points": OUTLINE, "radii": [0, 5, 8, 25, 0]}},
        "a disc (black), and the same with three of its corners rounded (red)",
    ),
}


def draw(directory):
    """Pictures of these keys: name of the file and what it shows, by title of the table and name of the key."""
    drawn = {}
    for key, (*fillets, said) in FILLETS.items():
        blades = [_built(hub_fillet=fillet) for fillet in fillets]
        drawn["Fillet", key] = _saved(directory, f"Fillet-{key}", said, _across, blades)
    for key in (*PLACES, *ON_SIDES):
        side = ON_SIDES.get(key, key)
        blades = [_built(hub_fillet={"radius": radii}) for radii in (PLACES, {**PLACES, side: 2.0 * PLACES[side]})]
        said = "the foot around the blade (black), and with twice the radius there (red)"
        drawn["FilletRadii", key] = _saved(directory, f"FilletRadii-{key}", said, _feet, blades)
    for key, cut in CUTS.items():
        blades = [_built(), _built(cut={key: cut})]
        drawn["Cut", key] = _saved(directory, f"Cut-{key}", "what is left of the blade (red)", _covered, blades)
    drawn["AtRadius", "radius"], drawn["AtX", "x"] = drawn["Cut", "trailing_edge"], drawn["Cut", "leading_edge"]
    for (title, key), (before, after, said) in DISCS.items():
        discs = [_built(**({} if disc is None else {"disc": disc})) for disc in (before, after)]
        drawn[title, key] = _saved(directory, f"{title}-{key}", said, _half_sections, discs)
    return drawn


def _built(**tables):
    document = tomllib.loads(example_text(SHOWN))
    del document["tip_clearance"]
    return design_from({**document, "tolerance": 1e-5, **tables}, SHOWN).build()


def _saved(directory, name, said, panel, blades):
    figure = Figure(figsize=(4.2, 2.4))
    axes = figure.add_subplot()
    panel(axes, blades)
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.savefig(directory / f"{name}.svg", bbox_inches="tight")
    return f"{name}.svg", said


def _across(axes, blades):
    """The blade, its fillet and the wall across the upper side at mid-chord, in the plane of wall and fillet."""
    for blade, colour in zip(blades, (BLACK, RED, BLUE), strict=True):
        fillet, side = blade.surfaces["hub_fillet_upper"], blade.surfaces["upper"]
        height = np.linspace(0.0, 1.0, 61)
        foot = fillet(0.5, 0.0)
        along_wall = fillet.derivative(0.5, 0.0, 0, 1)
        along_wall /= -np.linalg.norm(along_wall)
        upright = np.cross(along_wall, fillet.derivative(0.5, 0.0, 1, 0))
        upright /= np.linalg.norm(upright)
        upright *= np.sign((fillet(0.5, 1.0) - foot) @ upright)
        points = np.concatenate([fillet(0.5, height), side(0.5, 0.25 * height)])
        origin = blades[0].surfaces["hub_fillet_upper"](0.5, 0.0)
        flat = np.stack([(points - origin) @ along_wall, (points - foot) @ upright], axis=-1)
        flat = flat[flat[:, 1] < 5e-3]
        axes.plot(*flat.T, color=colour, linewidth=1.0)
        axes.plot([flat[0, 0], flat[0, 0] + 3e-3], [0.0, 0.0], color=BLACK, linewidth=1.0)


def _feet(axes, blades):
    """The feet around the section at the hub (grey), in its plane."""
    for blade, colour in zip(blades, (BLACK, RED), strict=True):
        axes.plot(*foot_in_plane(blade, "hub", 0.0).T, color=colour, linewidth=1.0)
    for curve in blades[0].plain.section(0.0).curves.values():
        axes.plot(*np.real(curve(np.linspace(0.0, 1.0, 401))).T, color="grey", linewidth=0.8)


def _covered(axes, blades):
    """What blades cover in the meridional plane: the first pale, the last red."""
    for blade, colour in zip(blades, ("0.85", "#e8b0b0"), strict=False):
        u, v = (0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)) for count in (61, 13))
        for side in blade.sides:
            x, y, z = np.moveaxis(side.grid(u, v), -1, 0)
            flat = np.stack([x, np.hypot(y, z)], axis=-1)
            corners = flat[:-1, :-1], flat[1:, :-1], flat[1:, 1:], flat[:-1, 1:]
            axes.add_collection(
                PolyCollection(np.stack(corners, axis=2).reshape(-1, 4, 2), facecolors=colour, edgecolors=colour)
            )
    _walls(axes, blades[0])


def _walls(axes, blade):
    view = blade.plain.exact.meridional_view
    for name in ("hub", "shroud"):
        axes.plot(*view.lines[name].points.T, color=BLACK, linewidth=1.0)


def _half_sections(axes, blades):
    _covered(axes, [blades[0].plain])
    for blade, colour in zip(blades, (BLACK, RED), strict=True):
        if blade.design.disc is not None:
            for line in carried_lines(sector(blade))["disc"]:
                axes.plot(*(1e-3 * line).T, color=colour, linewidth=1.0)
