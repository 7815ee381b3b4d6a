"""The native blade: promises, convergence, ends, purity, derivatives."""

import numpy as np
import pytest

from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.errors import DesignError
from bladewright.nurbs.mass_properties import mass_properties
from machines import COARSE, built
from machines.unified import CASCADE, FAN, IMPELLER, INFLOW


def test_every_promise_is_kept(blade):
    promises = blade.conformance
    assert promises.kept
    assert promises.metal_angle_at_walls < 1e-6
    assert promises.metal_angle_between < 1e-2
    assert promises.edge_radius < 1e-3
    assert promises.edge_tangent_planes < 1e-9
    assert promises.edge_curvatures < 1e-6
    assert promises.walls < 1e-7
    assert promises.surface < 1e-6
    assert set(promises.to_dict()) >= set(promises.limits)


def test_the_edges_are_shared_to_the_bit(blade):
    upper, lower = (blade.surfaces[name].control_points for name in ("upper", "lower"))
    assert np.array_equal(upper[0], lower[0])
    assert np.array_equal(upper[-1], lower[-1])
    assert upper[1] - upper[0] == pytest.approx(lower[0] - lower[1], abs=1e-17)


def test_a_tighter_tolerance_is_reached_with_more_poles():
    loose, tight = (INFLOW.changed("tolerance", tolerance).build() for tolerance in (1e-4, 1e-7))
    assert loose.error < 1e-4
    assert tight.error < 1e-7
    assert np.prod(tight.knots.poles) > np.prod(loose.knots.poles)


def test_building_is_pure_and_held_knots_give_the_same_blade(blade):
    again = blade.design.build()
    held = blade.design.build(knots=blade.knots)
    for name in ("upper", "lower"):
        net = blade.surfaces[name].control_points
        assert np.array_equal(net, again.surfaces[name].control_points)
        assert np.array_equal(net, held.surfaces[name].control_points)
    assert blade.design == again.design


def test_results_are_read_only(blade):
    with pytest.raises(ValueError, match="read-only"):
        blade.surfaces["upper"].control_points[0, 0, 0] = 1.0
    with pytest.raises(TypeError):
        blade.surfaces["upper"] = None


def test_each_ends_boundary_lies_on_its_wall_where_the_sides_end(blade):
    for wall, v in (("hub", 0.0), ("shroud", 1.0)):
        face = blade.surfaces[wall]
        lower, upper = face.boundary
        s = np.linspace(0.0, 1.0, 401)
        for curve, name, at in ((lower, "lower", s), (upper, "upper", 1.0 - s)):
            uv = curve(s)
            gap = face.surface(uv[:, 0], uv[:, 1]) - blade.surfaces[name](at, v)
            assert np.max(np.linalg.norm(gap, axis=-1)) < 1e-7 * blade.chord


def test_walls_are_the_channels_own_surfaces(blade):
    exact = blade.exact
    for wall in ("hub", "shroud"):
        surface = blade.surfaces[wall].surface
        meridian = exact.channel.curve(wall)
        u, v = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 7), indexing="ij")
        points = surface(u, v)
        radius = np.hypot(points[..., 1], points[..., 2]) if exact.mapping.revolved else points[..., 2]
        on_line = meridian(u)
        assert np.stack([points[..., 0], radius], axis=-1) == pytest.approx(on_line, abs=1e-15)


def test_volume_and_area_agree_with_closed_forms_of_a_prismatic_vane():
    from bladewright.blade.design.families import prismatic
    from bladewright.section.unified import UnifiedSection

    section = UnifiedSection(
        name="vane",
        length_unit="mm",
        axial_chord=40.0,
        stagger=-40.0,
        metal_angle_in=10.0,
        metal_angle_out=-65.0,
        tangent_in=0.4,
        tangent_out=0.5,
        leading_edge_radius=0.05,
        trailing_edge_radius=0.01,
        thickness_upper=(0.06, 0.2, 0.1, 0.02),
        thickness_lower=(0.06, 0.1, 0.06, 0.02),
        span=75.0,
    )
    flat, blade = section.build(), prismatic(section).build()
    assert blade.properties.volume == pytest.approx(flat.area * 75e-3, rel=1e-7)
    assert blade.properties.area == pytest.approx(flat.perimeter * 75e-3 + 2.0 * flat.area, rel=1e-6)
    assert blade.properties.centroid == pytest.approx([*flat.centroid, 37.5e-3], abs=1e-8)


@pytest.mark.parametrize("design", [IMPELLER, CASCADE], ids=lambda design: design.name)
def test_properties_agree_with_the_divergence_theorem_over_all_faces(design):
    """Two formulas: fields along theta through the sides alone, fluxes of x / 3... through sides and trimmed ends."""
    blade = built(design)
    own = blade.properties
    general = mass_properties([(blade.surfaces[name], sign) for name, sign in blade.orientations.items()])
    # the sides end within 1e-7 of the chord off the walls, which closes the body by so much of the ends' area
    assert own.volume == pytest.approx(general.volume, rel=1e-7)
    assert own.centroid == pytest.approx(general.centroid, abs=1e-8 * blade.chord)
    assert own.inertia == pytest.approx(general.inertia, abs=1e-7 * np.max(np.abs(general.inertia)))
    assert own.areas == pytest.approx(general.areas, rel=1e-9)
    assert own.openness < 1e-8


def test_the_extended_blade_is_the_same_blade_between_its_walls():
    blade = built(IMPELLER)
    longer = blade.extended(0.1)
    v = np.linspace(0.0, 1.0, 9)
    u = np.linspace(0.0, 1.0, 31)
    for name in ("upper", "lower"):
        inside = longer.surfaces[name].grid(u, (v + 0.1) / 1.2)
        assert inside == pytest.approx(blade.surfaces[name].grid(u, v), abs=1e-13)
    assert longer.properties.volume > blade.properties.volume
    assert longer.properties.openness < 1e-12
    with pytest.raises(DesignError, match=r"0\.5"):
        blade.extended(0.7)


@pytest.mark.parametrize("path", ["stagger[1]", "channel.shroud[1].x", "thickness_upper[1]", "leading_edge_radius"])
def test_the_control_net_carries_a_complex_step_at_held_knots(path):
    knots, value = built(IMPELLER.changed("tolerance", COARSE)).knots, IMPELLER.parameters()[path]
    stepped = IMPELLER.changed(path, value + 1e-30j).build(knots=knots)
    step = 1e-4 * max(abs(value), 1e-2)
    ahead, back = (IMPELLER.changed(path, value + sign * step).build(knots=knots) for sign in (1, -1))
    for name in ("upper", "lower"):
        analytic = np.imag(stepped.surfaces[name].control_points) / 1e-30
        central = (ahead.surfaces[name].control_points - back.surfaces[name].control_points) / (2.0 * step)
        # central differences of a step of 1e-4 err by its square
        assert analytic == pytest.approx(central, abs=1e-5 * np.max(np.abs(analytic)))
    volume = np.imag(stepped.properties.volume) / 1e-30
    central = (ahead.properties.volume - back.properties.volume) / (2.0 * step)
    assert volume == pytest.approx(central, rel=1e-5)


@pytest.mark.parametrize(
    ("design", "changes", "words"),
    [
        (FAN, {"channel": "swapped"}, ["channel", "swapped", "exchange"]),
        (FAN, {"channel.hub[0].r": 290.0}, ["channel", "fold"]),
        (FAN, {"blade_count": 400}, ["blade_count", "400", "intersect", "fewer"]),
        (CASCADE, {"pitch": 3.0}, ["pitch", "3", "intersect", "larger"]),
        (FAN, {"leading_edge_radius": 0.5}, ["leading_edge_radius", "at most"]),
        (FAN, {"blade_count": 0}, ["blade_count", "0"]),
        (FAN, {"tolerance": 1e-12}, ["tolerance", "1e-12"]),
        (INFLOW, {"channel.trailing_edge[0].r": 1.0, "channel.hub[2].r": -9.0}, ["channel", "radius"]),
        (FAN, {"tangent_in": 0.0}, ["tangent_in", "0"]),
        (FAN, {"metal_angle_in[2]": 90.0}, ["metal_angle_in[2]", "90"]),
        (FAN, {"stagger": float("nan")}, ["stagger", "finite"]),
        (FAN, {"thickness_upper[0]": 0.0}, ["thickness_upper[0]", "positive"]),
    ],
)
def test_an_impossible_blade_is_refused_with_path_value_and_cure(design, changes, words):
    if changes.get("channel") == "swapped":
        channel = design.channel
        changes = {
            "channel": type(channel)(
                leading_edge=channel.trailing_edge,
                trailing_edge=channel.leading_edge,
                hub=channel.hub[::-1],
                shroud=channel.shroud[::-1],
            )
        }
    with pytest.raises(DesignError) as caught:
        design.changed(changes).build()
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert "\n" not in message


def test_rational_sides_keep_every_promise():
    weighted = INFLOW.changed({"weights_upper": (1.0, 2.5, 0.8), "weights_lower": ((1.0, 1.4), 0.7)})
    blade = weighted.build()
    plain = INFLOW.build()
    assert blade.conformance.kept
    assert np.max(np.abs(blade.surfaces["upper"](0.5, 0.5) - plain.surfaces["upper"](0.5, 0.5))) > 1e-4 * blade.chord


def test_weights_of_one_change_nothing():
    weighted = exact_unified_blade(INFLOW.changed({"weights_upper": (1.0,), "weights_lower": (1.0, 1.0)}))
    plain = exact_unified_blade(INFLOW)
    v, s = np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 21)
    for with_weights, without in zip(weighted.sections(v).points(s), plain.sections(v).points(s), strict=True):
        assert with_weights == pytest.approx(without, abs=1e-15)


def test_sections_have_the_areas_that_make_up_the_volume_of_a_cascade():
    v, w = np.polynomial.legendre.leggauss(6)
    straight = CASCADE.changed(
        "channel",
        type(CASCADE.channel)(leading_edge=((0.0, 0.0), (0.0, 90.0)), trailing_edge=((60.0, 0.0), (50.0, 90.0))),
    )
    blade = straight.build()
    areas = [blade.section((place + 1.0) / 2.0).area for place in v]
    assert blade.properties.volume == pytest.approx(90e-3 * np.dot(w, areas) / 2.0, rel=1e-7)


@pytest.mark.parametrize(("former", "name"), [("promises", "conformance"), ("misfit", "approximation_error")])
def test_former_names_of_a_blade_still_work_and_warn(blade, former, name):
    with pytest.warns(DeprecationWarning, match=f"Blade.{former} is called {name} now"):
        assert getattr(blade, former) is getattr(blade, name)
