"""The Jacobian of control nets: equal to rebuilding one by one, linear in points, the transpose of its pullback."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.blade.native.interpolation import native_sides
from bladewright.derivatives import net_jacobian
from bladewright.derivatives.complex_step import stepped
from bladewright.numerics.quadrature import panels
from machines import built
from machines.coarse import CASCADE, CLEARED, RADIAL, ROTOR, SECTION
from machines.sectioned import BLUNT, PLATE

STEP = 1e-30
ROUNDING = 1e-12
"""of the largest derivative: the rounding of a build's interpolations, which is some 1e-14 of the coordinates"""


@pytest.fixture(scope="module")
def found(design, blade):
    return bw.net_jacobian(design, knots=blade.knots)


def test_the_derivatives_are_those_of_a_build_with_the_step_alone(design, blade, found):
    values = design.parameters()
    assert found.paths == tuple(values)

    def carried(steps):
        moved = design.changed({path: values[path] + STEP * 1j * size for path, size in steps.items()})
        exact = exact_unified_blade(moved, blade.knots.tip)
        return np.imag(native_sides(exact.sections(blade.knots.sites_v), blade.knots)) / STEP

    nets = np.stack([found.nets["upper"], found.nets["lower"]], axis=1)
    for place in range(0, len(values), 9):
        alone = carried({found.paths[place]: 1.0})
        assert nets[place] == pytest.approx(alone, abs=ROUNDING * np.abs(alone).max()), found.paths[place]
    # and all of them in one sum, each by a share of its own of what moves the nets alike
    size = np.abs(nets).max(axis=(1, 2, 3, 4))
    way = np.divide(np.random.default_rng(5).uniform(0.5, 1.0, len(size)), size, out=0.0 * size, where=size > 0.0)
    together = carried(dict(zip(found.paths, way, strict=True)))
    assert np.tensordot(way, nets, axes=1) == pytest.approx(together, abs=ROUNDING * np.sum(way * size))


def test_points_are_linear_in_the_nets_and_grow_in_any_shape(design, blade, found):
    u, v = np.linspace(0.0, 1.0, 7)[:, None], np.linspace(0.0, 1.0, 4)
    both = found.points("upper", u, v)
    assert both.shape == (len(found.paths), 7, 4, 3)
    path = "stagger[1]"
    built = next(stepped(design, blade, [path]))
    carried = np.imag(built.surfaces["upper"](u, v)) / STEP
    assert both[found.paths.index(path)] == pytest.approx(carried, abs=1e-15)
    assert found.points("upper", 0.3, 0.4).shape == (len(found.paths), 3)


@pytest.mark.parametrize("design", [PLATE, BLUNT], ids=lambda design: design.name)
def test_faces_of_blunt_edges_and_ends_follow_all_parameters_at_once_as_one_by_one(design):
    base, values = built(design), design.parameters()
    paths = [path for path in values if values[path]][::8]
    for path, made in zip(paths, stepped(design, base, paths), strict=True):
        alone = design.changed(path, values[path] + STEP * 1j).build(knots=base.knots)
        for name, face in alone.surfaces.items():
            own = made.surfaces[name]
            pairs = zip(own.boundary, face.boundary, strict=True) if name in design.ends else [(own, face)]
            for mine, theirs in pairs:
                off = np.imag(mine.control_points - theirs.control_points) / STEP * values[path]
                assert np.max(np.abs(off)) < 1e-12, (path, name)


@pytest.mark.parametrize("at_once", [7, 50_000])
def test_forward_and_reverse_agree_in_the_sum_of_products(found, at_once, monkeypatch):
    monkeypatch.setattr(net_jacobian, "POINTS_AT_ONCE", at_once)
    random = np.random.default_rng(4)
    u, v = random.random((2, 5, 6))
    bars = {name: (u, v, random.standard_normal((5, 6, 3))) for name in ("upper", "lower")}
    reverse = np.array(list(found.pulled_back(bars).values()))
    forward = sum(np.einsum("kijd,ijd->k", found.points(name, u, v), bar) for name, (u, v, bar) in bars.items())
    assert reverse == pytest.approx(forward, abs=1e-12 * np.abs(forward).max())


@pytest.mark.parametrize("design", [ROTOR, CLEARED, CASCADE], ids=lambda design: design.name)
def test_the_walls_below_trimmed_ends_have_their_sum_of_products_too(design):
    ends = design.ends
    blade = built(design)
    free = ["channel.*", "stagger[0]", *(["*_clearance*"] if design.tip_clearance else [])]
    found = bw.net_jacobian(design, names=ends, knots=blade.knots, free=free)
    random = np.random.default_rng(4)
    u, v, bar = random.random((9,)), random.random((9,)), random.standard_normal((9, 3))
    for name in ends:
        assert found.shapes[name].control_points.shape == blade.surfaces[name].surface.control_points.shape
        reverse = np.array(list(found.pulled_back({name: (u, v, bar)}).values()))
        forward = np.einsum("kid,id->k", found.points(name, u, v), bar)
        assert np.abs(forward).max() > 0.0
        assert reverse == pytest.approx(forward, abs=1e-12 * np.abs(forward).max())


def test_a_wall_moves_with_the_channel_as_differences_of_it_say():
    design = ROTOR
    blade = built(design)
    u, theta = np.array([0.2, 0.7]), np.array([0.05, -0.02])

    def at(value):
        end = design.changed("channel.hub[0].r", value).build(knots=blade.knots).surfaces["hub"]
        return end.surface(u, end.revolution.v(theta))

    value, step = design.channel.hub[0].r, 1e-2
    # linear in a control point of the wall: a difference has no error but rounding
    difference = (at(value + step) - at(value - step)) / (2.0 * step)
    found = bw.net_jacobian(design, names=["hub"], free="channel.hub[0].r", knots=blade.knots)
    v = blade.surfaces["hub"].revolution.v(theta)
    assert found.points("hub", u, v)[0] == pytest.approx(difference, abs=1e-12)


def test_a_rational_section_s_curves_have_theirs():
    section = SECTION.build()
    found = bw.net_jacobian(SECTION)
    assert set(found.shapes) == {"upper", "lower"}
    assert found.weights["upper"].shape == (len(found.paths), len(section.curves["upper"].control_points))
    assert np.abs(found.weights["upper"][found.paths.index("weights_upper[1]")]).max() > 0.1
    u = np.linspace(0.0, 1.0, 9)
    forward = found.points("upper", u)
    for place, path in enumerate(found.paths):
        built = SECTION.changed(path, SECTION.parameters()[path] + STEP * 1j).build()
        assert forward[place] == pytest.approx(np.imag(built.curves["upper"](u)) / STEP, abs=1e-16)
        assert found.nets["upper"][place] == pytest.approx(
            np.imag(built.curves["upper"].control_points) / STEP, abs=1e-16
        )
    bar = np.random.default_rng(1).standard_normal((9, 2))
    reverse = np.array(list(bw.pullback(SECTION, {"upper": (u, bar)}).values()))
    product = np.einsum("kid,id->k", forward, bar)
    assert reverse == pytest.approx(product, abs=1e-12 * np.abs(product).max())


def test_the_volume_s_gradient_is_the_pullback_of_its_normals():
    # dV = integral of n . dS over what moves: the walls keep their place when an angle or a thickness changes
    blade = built(RADIAL)
    (u, along), (v, across) = (panels(np.unique(knots), 8) for knots in (blade.knots.u, blade.knots.v))
    bars = {}
    for name, side in zip(("upper", "lower"), blade.sides, strict=True):
        normal = np.cross(side.grid(u, v, 1, 0), side.grid(u, v, 0, 1))
        bars[name] = (u[:, None], v, blade.orientations[name] * along[:, None, None] * across[:, None] * normal)
    free = ["stagger*", "thickness*", "metal*"]
    pulled = bw.pullback(RADIAL, bars, knots=blade.knots, free=free)
    exact = bw.sensitivity(RADIAL, lambda blade: blade.properties.volume, knots=blade.knots, free=free)
    # a blade's ends lie off the walls by up to a tenth of a millionth of its chord
    scale = max(abs(value) for value in exact.values())
    assert list(pulled.values()) == pytest.approx([float(value) for value in exact.values()], abs=1e-6 * scale)
