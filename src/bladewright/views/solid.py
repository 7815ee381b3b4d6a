"""Shaded views in space: the blade among its neighbours on the hub, and the passage as a see-through body."""

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bladewright.domain.passage import pieces_of
from bladewright.numerics.elementary import length, unit
from bladewright.nurbs.basis import Reals
from bladewright.nurbs.curve import Curve
from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface
from bladewright.views.faces import sampled
from bladewright.views.flow_marks import draw_marks
from bladewright.views.raster import Camera, Polyline, ShadedGrid, axes_towards, framing_camera, rendered
from bladewright.views.sections import ISOLATED_PITCH, cosine_spacing
from bladewright.views.style import INK, per_metre, unit_name

if TYPE_CHECKING:
    from bladewright.blade.native.blade import Blade
    from bladewright.domain.passage import Passage


BLADE, NEIGHBOUR, HUB = (0.16, 0.47, 0.68), (0.74, 0.78, 0.83), (0.70, 0.68, 0.64)
"""Colours (red, green, blue) of the blade, of its neighbours and of the hub."""
EDGE, FAINT = (0.05, 0.16, 0.26), (0.55, 0.60, 0.65)
"""Colours of the main and of the auxiliary lines."""
FILLET = (0.40, 0.73, 0.67)
"""Colour that is mixed into that of a blade for its fillets."""
SIDES, EDGES = ("upper", "lower"), ("leading_edge", "trailing_edge")
SLOPE_STEP = 0.01
"""Step of u from which the slope of a wall at a nose is taken."""
FEW = 9
"""Points across a fillet, a strip and an end."""
BORE_RADIUS = 0.8
"""Radius of the bore drawn in the hub of a whole row, in smallest radii of the hub. It only shows that the hub is a
wheel; no design says it."""
DISC_SLOPE = 0.2
"""Axial extent of a hub, in radial extents, below which it is seen as a disc from the shroud's side: from upstream the
blades would hide behind it."""
STEEP = 0.5
"""Radial extent of a hub, in axial extents, from which on it hides the blades from one end."""
GRID, COARSE = (121, 41), (57, 17)
"""Points along and across a side of the blade, and of its neighbours, which are drawn many times."""
WALL_COLOURS = {"hub": (0.88, 0.80, 0.66), "shroud": (0.88, 0.80, 0.66), "periodic": (0.80, 0.86, 0.92)}
"""Colours of the inside of the faces, by the beginning of their names."""
OPENING, GLASS = (0.78, 0.88, 0.80), (0.66, 0.80, 0.90)
"""Colours of the inside of inlet and outlet, and of every face seen from outside."""
PIECE_POINTS = 33
"""Points along and across a smooth piece of a face."""
NAME_PLACES = np.linspace(0.2, 0.8, 7)
"""Parameters along and across a face at which its name may be written."""
WALL_LINES = 6
"""Lines of constant u, and lines of constant v, on a smooth piece of a wall."""


def draw_solid(axes: Axes, blade: "Blade", *, neighbours: int | None, width: int, view: Reals | None = None) -> None:
    """Draw the blade with `neighbours` on either side (None: the whole row) on the hub, `width` pixels wide.

    `view` holds the axes (3, 3) of the viewer, `viewpoint(blade)` where not given. Arrows say where the flow comes from
    and which way the row turns, as far as the design says it.
    """
    turns = positions(blade, neighbours)
    surfaces, polylines = [], []
    neighbour = blade_surfaces(blade, COARSE, NEIGHBOUR)
    for turn in turns:
        own = turn == 0.0
        parts, lines = blade_surfaces(blade, GRID, BLADE) if own else neighbour
        surfaces += [placed(blade, surface, turn) for surface in parts]
        polylines += [
            Polyline(points=moved(blade, line, turn), colour=EDGE if own else FAINT, width=2 if own else 1)
            for line in lines
        ]
    blades = np.concatenate([surface.points.reshape(-1, 3) for surface in surfaces])
    surfaces += hub_surfaces(blade, turns)
    view = viewpoint(blade) if view is None else view
    camera = framing_camera(view, np.concatenate([blades, surfaces[-1].points.reshape(-1, 3)]))
    show_rendering(axes, camera, rendered(surfaces, polylines, camera, width))
    draw_marks(axes, blade, camera)


def show_rendering(axes: Axes, camera: Camera, rendering: Reals) -> None:
    """Draw a rendered picture, with the directions of x, y and z and a scale bar under it."""
    left, low = camera.corner
    wide, high = camera.extent
    axes.imshow(rendering, extent=(left, left + wide, low, low + high), interpolation="antialiased")
    axes.set_axis_off()
    _scale(axes, camera)


def positions(blade: "Blade", neighbours: int | None) -> list[float]:
    """Rotations [rad], or shifts in a cascade [mm], of the blades to draw; 0 is the blade itself."""
    from bladewright.section.checks import UNITS

    design = blade.design
    if design.blade_count is not None:
        count = design.blade_count
        number = count if neighbours is None else min(2 * neighbours + 1, count)
        return [2.0 * np.pi / count * (index - number // 2) for index in range(number)]
    pitch = (design.pitch or 0.0) * UNITS[design.length_unit]
    neighbours_each_side = 0 if pitch > ISOLATED_PITCH * blade.chord else 2 if neighbours is None else neighbours
    return [per_metre() * pitch * index for index in range(-neighbours_each_side, neighbours_each_side + 1)]


def moved(blade: "Blade", points: Reals, turn: float) -> Reals:
    """Points (..., 3) moved to the blade at rotation or shift `turn`."""
    if not blade.exact.mapping.revolved:
        return points + np.array([0.0, turn, 0.0])
    return _turned(points, turn)


def _turned(points: Reals, turn: float) -> Reals:
    """Points (..., 3) rotated about x by an increase of theta."""
    cosine, sine = np.cos(turn), np.sin(turn)
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, y * cosine + z * sine, z * cosine - y * sine], axis=-1)


def placed(blade: "Blade", surface: ShadedGrid, turn: float) -> ShadedGrid:
    """A surface moved to the blade at rotation or shift `turn`."""
    normals = _turned(surface.normals, turn) if blade.exact.mapping.revolved else surface.normals
    return ShadedGrid(points=moved(blade, surface.points, turn), normals=normals, colour=surface.colour)


def blade_surfaces(
    blade: "Blade", size: tuple[int, int], colour: tuple[float, float, float]
) -> tuple[list[ShadedGrid], list[Reals]]:
    """Sides and ends of the blade [mm] with their normals, and the lines between them."""
    surfaces, lines = [], list[Reals]()
    hidden = ["hub"] if blade.exact.mapping.revolved else []
    for name, face in blade.surfaces.items():
        if name in hidden:
            continue
        points, normals = sampled(face, *places_on(name, size))
        own = mixed(colour, FILLET) if "fillet" in name and colour == BLADE else colour
        surfaces.append(ShadedGrid(points=points, normals=normals, colour=own))
        rows = edge_rows(blade, name) or []
        lines += [points[:, row] for row in rows if row or "hub" not in hidden or "fillet" in name]
    return surfaces, lines


def edge_rows(blade: "Blade", name: str) -> list[int] | None:
    """The rows of points across a face of a blade that are its edges, where it goes on smoothly at the others."""
    if name in SIDES:
        return [row for wall, row in (("hub", 0), ("shroud", -1)) if f"{wall}_strip_{name}" not in blade.surfaces]
    return [0, -1] if "fillet" in name else [] if "strip" in name else None


def places_on(name: str, size: tuple[int, int]) -> tuple[Reals, Reals]:
    """Parameters along and across a face of a blade, of which a side has this size."""
    along, across = cosine_spacing(size[0]), np.linspace(0.0, 1.0, size[1])
    if name in SIDES:
        return along, across
    if name in EDGES:
        return np.linspace(0.0, 1.0, 5), across
    return (cosine_spacing(FEW) if name.endswith(EDGES) else along), cosine_spacing(FEW)


def mixed(one: tuple[float, float, float], other: tuple[float, float, float]) -> tuple[float, float, float]:
    """The colour between two."""
    red, green, blue = (0.5 * (a + b) for a, b in zip(one, other, strict=True))
    return red, green, blue


def hub_surfaces(blade: "Blade", turns: list[float]) -> list[ShadedGrid]:
    """The hub under the blades that are drawn [mm], a little longer than they are; under a whole row with its bore."""
    exact, wall = blade.exact, per_metre() * _hub_wall(blade)
    base = per_metre() * np.concatenate(
        [np.real(blade.surfaces[name](cosine_spacing(41), 0.0)) for name in ("upper", "lower")]
    )
    if not exact.mapping.revolved:
        margin = 0.15 * float(np.ptp(base[:, 1]))
        extent = np.linspace(turns[0] + base[:, 1].min() - margin, turns[-1] + base[:, 1].max() + margin, 41)
        return [_hub_surface(np.stack(np.broadcast_arrays(wall[:, :1], extent, wall[:, 1:]), axis=-1))]
    wall = wall[wall[:, 1] > 0.0]
    whole = len(turns) == blade.design.blade_count
    if whole:
        theta = np.linspace(0.0, 2.0 * np.pi, 361)
        bore = BORE_RADIUS * wall[:, 1].min()
        rim = [np.array([[x, radius], [x, bore]]) for x, radius in wall[[0, -1]]]
        profiles = [np.array([rim[0][1], rim[1][1]]), *rim, wall]
    else:
        around, margin = np.arctan2(base[:, 1], base[:, 2]), 0.5 * np.pi / (blade.design.blade_count or 1)
        theta = np.linspace(turns[0] + around.min() - margin, turns[-1] + around.max() + margin, 181)
        profiles = [wall]
    surfaces = []
    for profile in profiles:
        x, radius = profile[:, :1], profile[:, 1:]
        grid = np.stack(np.broadcast_arrays(x, radius * np.sin(theta), radius * np.cos(theta)), axis=-1)
        surfaces.append(_hub_surface(grid))
    return surfaces


def _hub_wall(blade: "Blade") -> Reals:
    """Points (61, 2) [m] of the hub, or of the curve that cuts the blade there, a little past both of its edges."""
    share, cut = np.linspace(0.0, 1.0, 61), blade.design.cut
    if cut is not None and cut.hub is not None:
        curve = blade.end_wall(blade.design.ends[0])[0]
        start, end = curve.domain
        return np.real(curve(start + (end - start) * share))
    stations = blade.exact.sections(np.zeros(1))
    u = np.real(stations.on_lines(np.concatenate(stations.plane_points(cosine_spacing(41)), axis=-2))[0])
    before, after = _past_section(blade, float(u.min()), float(u.max()))
    low, high = min(float(u.min()) - before, 0.0) - 0.06, max(float(u.max()) + after, 1.0) + 0.06
    return blade.exact.wall_points("hub", low + (high - low) * share)


def _past_section(blade: "Blade", low: float, high: float) -> tuple[float, float]:
    """How far in u a fillet's foot reaches before and behind the section at the hub, whose noses are at these u."""
    if not any(name.startswith("hub_fillet") for name in blade.surfaces):
        return 0.0, 0.0
    foot = np.concatenate([np.real(curve(np.linspace(*curve.domain, 101))) for curve in blade.end_outline("hub")])
    radius = length(foot[:, 1:]) if blade.exact.mapping.revolved else foot[:, 2]
    places, found = np.stack([foot[:, 0], radius], axis=-1), []
    for u, way in ((low, -1.0), (high, 1.0)):
        nose, inside = blade.plain.exact.wall_points("hub", np.array([u, u - way * SLOPE_STEP]))
        slope = (nose - inside) / SLOPE_STEP
        found.append(max(float(np.max((places - nose) @ slope) / (slope @ slope)), 0.0))
    return found[0], found[1]


def _hub_surface(grid: Reals) -> ShadedGrid:
    return ShadedGrid(points=grid, normals=np.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)), colour=HUB)


def viewpoint(blade: "Blade") -> Reals:
    """The axes (3, 3) of a viewer: at the smaller end of the hub, or upstream of a cylindrical one.

    A hub that is a disc is seen from the shroud's side.
    """
    if not blade.exact.mapping.revolved:
        return axes_towards((-0.55, -0.75, 0.50), (0.0, 0.0, 1.0))
    first, last = blade.exact.wall_points("hub", np.array([0.0, 1.0]))
    run, rise = last - first
    if DISC_SLOPE * abs(rise) > abs(run):
        aside = blade.exact.wall_points("shroud", np.array([0.0, 1.0]))[:, 0] - np.array([first[0], last[0]])
        return axes_towards((0.74 if float(np.mean(aside)) > 0.0 else -0.74, 0.42, 0.52), (0.0, 0.0, 1.0))
    narrows = first[1] - last[1] > 0.15 * first[1]
    smaller, larger = (last, first) if narrows else (first, last)
    return axes_towards((0.74 if smaller[0] > larger[0] else -0.74, 0.42, 0.52), (0.0, 0.0, 1.0))


def viewpoints(blade: "Blade", *, opposite: bool = False) -> tuple[Reals, Reals]:
    """The axes of the viewer, and of one who sees the blade's other side.

    He stands at the opposite end of the row, but where the hub would hide it: then at the same end, on the other side,
    unless he is to see what carries the blades from the `opposite` end.
    """
    first = viewpoint(blade)
    x, y, z = first[2]
    start, end = blade.exact.wall_points("hub", np.array([0.0, 1.0]))
    run, rise = end - start
    hidden = not opposite and blade.exact.mapping.revolved and rise * rise > (STEEP * run) ** 2
    return first, axes_towards((x if hidden else -x, -y, z), (0.0, 0.0, 1.0))


def _scale(axes: Axes, camera: Camera) -> None:
    """Draw the directions of the axes and a scale bar in a strip under the picture."""
    left, bottom = camera.corner
    size = float(np.max(camera.extent))
    step = size / 6.0
    tens = 10.0 ** np.floor(np.log10(step))
    bar = float(tens * max(each for each in (1.0, 2.0, 5.0) if each * tens <= step))
    start, height = left + 0.22 * size, bottom - 0.09 * size
    axes.plot([start, start + bar], [height, height], color=INK, linewidth=2.0, solid_capstyle="butt")
    near: dict[str, Any] = {"textcoords": "offset points", "ha": "center"}
    axes.annotate(f"{bar:g} {unit_name()}", (start + bar / 2.0, height), xytext=(0.0, -4.0), va="top", **near)
    origin = np.array([left + 0.09 * size, bottom - 0.08 * size])
    arrow = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
    for index, name in enumerate("xyz"):
        tip = 0.07 * size * camera.axes[:2, index]
        away = 8.0 * tip / max(float(np.sqrt(tip @ tip)), 1e-12)
        axes.annotate("", tuple(origin + tip), xytext=tuple(origin), arrowprops=arrow)
        axes.annotate(name, tuple(origin + tip), xytext=tuple(away), va="center", **near)
    axes.set_ylim(bottom - 0.16 * size, bottom + camera.extent[1])
    axes.set_xlim(left, left + camera.extent[0])


def draw_passage_solid(axes: Axes, passage: "Passage", *, size: tuple[int, int]) -> None:
    """Draw the passage [mm], at most `size` pixels wide and high: solid where seen from inside, else see-through."""
    u = np.linspace(0.0, 1.0, PIECE_POINTS)
    blade, rims = blade_surfaces(passage.blade, GRID, BLADE)
    solid, glass, lines = [], [], []
    for name, points, normals in outer_grids(passage, u):
        colour = WALL_COLOURS.get(name.partition("_")[0], OPENING)
        solid.append(ShadedGrid(points=points, normals=normals, colour=colour, side=-1))
        glass.append(ShadedGrid(points=points, normals=normals, colour=GLASS, side=1))
        if name.startswith("hub"):
            lines += [Polyline(points=line, colour=FAINT) for line in _lines(points)]
    lines += [Polyline(points=line, colour=EDGE) for line in outer_edges(passage)]
    lines += [Polyline(points=line, colour=EDGE, width=2) for line in rims]
    outside = np.concatenate([surface.points.reshape(-1, 3) for surface in solid])
    camera = framing_camera(viewpoint(passage.blade), outside)
    width = int(min(size[0], size[1] * camera.extent[0] / camera.extent[1]))
    show_rendering(axes, camera, rendered([*solid, *blade], lines, camera, width, glass=glass))
    occupied = [np.concatenate([camera.seen(surface.points).reshape(-1, 3)[:, :2] for surface in blade])]
    for name in ("inlet", "outlet"):
        occupied.append(_write_name(axes, camera, cast(Surface, passage.whole[name]), name, np.concatenate(occupied)))


def outer_grids(passage: "Passage", u: Reals) -> list[tuple[str, Reals, Reals]]:
    """Names, points (m, m, 3) [mm] at u (m,), and outward unit normals of the pieces of `outer_faces`."""
    found = []
    for name, sense in outer_faces(passage).items():
        face = passage.whole[name]
        if isinstance(face, TrimmedSurface) and passage.skin is not None:
            # the blade hides the hole at its end; an outline has its pieces in the order of the flow, and back
            *pieces, _ = face.boundary
            ahead, back = pieces[: len(pieces) // 2], pieces[: len(pieces) // 2 : -1]
            grids = [_sampled_between(face, *both, u) for both in zip(ahead, back, strict=True)]
        elif isinstance(face, TrimmedSurface):
            upper = face.boundary[2 if "blade_trailing_edge" in passage.whole else 1]
            grids = [_sampled_between(face, face.boundary[0], upper, u)]
        else:
            grids = [sampled(piece, u, u) for piece in pieces_of(name, face, passage.knots).values()]
        found += [(name, points, sense * normals) for points, normals in grids]
    return found


def outer_faces(passage: "Passage") -> dict[str, int]:
    """The faces without the blade's, with +1 where dS/du x dS/dv points out of the passage, and -1 elsewhere."""
    return {
        name: next(sense for face, sense in passage.orientations.items() if face.startswith(name))
        for name in passage.whole
        if name != "tip" and not name.startswith("blade")
    }


def _sampled_between(face: TrimmedSurface, lower: Curve, upper: Curve, u: Reals) -> tuple[Reals, Reals]:
    """`sampled` at u (m,) along and across of a trimmed face between two curves of its boundary, which run opposite."""
    first, last = (
        np.real(curve(start + (end - start) * at))
        for curve, at in ((lower, u), (upper, 1.0 - u))
        for start, end in [curve.domain]
    )
    own, around = np.moveaxis(first[:, None] + u[:, None] * (last - first)[:, None], -1, 0)
    along, across = (np.real(face.surface.derivative(own, around, *order)) for order in ((1, 0), (0, 1)))
    return per_metre() * np.real(face.surface(own, around)), unit(np.cross(along, across))


def _lines(points: Reals) -> list[Reals]:
    """Some lines along and across a grid of points."""
    at = np.linspace(0, PIECE_POINTS - 1, WALL_LINES).round().astype(int)
    return [*points[at], *np.swapaxes(points[:, at], 0, 1)]


def outer_edges(passage: "Passage") -> list[Reals]:
    """Lines where outer faces meet [mm]: the edges of the periodic boundaries, of inlet and outlet."""
    u, ends = np.linspace(0.0, 1.0, 401), np.array([0.0, 1.0])
    lines: list[Reals] = []
    for name in ("periodic_upper", "periodic_lower", "inlet", "outlet"):
        face = cast(Surface, passage.whole[name])
        lines += [*np.swapaxes(np.real(face.grid(u, ends)), 0, 1)]
        if name.startswith("periodic"):
            lines += [*np.real(face.grid(ends, u))]
    return [per_metre() * line for line in lines]


def _write_name(axes: Axes, camera: Camera, face: Surface, name: str, clear: Reals) -> Reals:
    """Write a face's name on it, as far as possible from points (n, 2) of the picture; return its place (1, 2)."""
    points = per_metre() * np.real(face.grid(NAME_PLACES, NAME_PLACES)).reshape(-1, 3)
    flat = camera.seen(points)[:, :2]
    clearances = np.min(length(flat[:, None] - clear), axis=1)
    best = flat[int(np.argmax(clearances))]
    halo = [withStroke(linewidth=3.0, foreground="white", alpha=0.7)]
    axes.text(float(best[0]), float(best[1]), name, ha="center", va="center", path_effects=halo)
    return best[None]
