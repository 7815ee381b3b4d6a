"""Every derivative of every built-in example agrees with central differences; what is wrong is found."""

import tomllib

import numpy as np
import pytest

import bladewright as bw
from bladewright.derivatives import step_study
from bladewright.derivatives.complex_step import varied_nets
from bladewright.derivatives.quantities import named_quantity
from bladewright.derivatives.step_study import IMAGINARY, LIMIT, STEPS, step_studies
from bladewright.errors import DerivativeError
from bladewright.files.examples import example_text, examples
from bladewright.files.reading import design_from
from bladewright.files.templates import template_text
from bladewright.section.unified import UnifiedSection
from machines import built, example
from machines.coarse import CASCADE, CLEARED

UNIFIED = [name for name in examples() if 'family = "unified' in example_text(name)]
BLADES = [name for name in UNIFIED if name != "turbine-section"]
IDLE = {"pitch", "span"}
"""which place the next blade, and make a solid of a section"""
BESIDE = ("density", "disc.", "shroud_ring.", "hub_fillet.", "shroud_fillet.")
"""what weighs and carries a blade, or lies below what a fillet leaves of its sides"""


def machine(name):
    design = example(name)
    return design, built(design)


def coarse(name):
    """At few poles: the same parameters through the same steps."""
    design = example(name).changed("tolerance", 1e-3)
    return design, built(design)


def swept(name, quantity, **options):
    design, base = machine(name)
    space = bw.variables(design, knots=getattr(base, "knots", None))
    return list(step_studies(design, base, named_quantity(base, quantity), space, **options))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name == "marine-propeller" else []) for name in BLADES]
)
def test_every_parameter_of_every_blade_has_the_derivative_that_differences_give(name):
    design, base = coarse(name)
    values, space = design.parameters(), bw.variables(design, knots=base.knots)
    # one that stands at its limit has its differences to one side
    at_limit = [path for path in space.paths if path.startswith("tangent") and values[path] == 1.0]
    free = [path for path in space.paths if path not in at_limit]
    jacobian = bw.net_jacobian(design, free=free, knots=base.knots)
    exact = np.stack([jacobian.nets["upper"], jacobian.nets["lower"]], axis=1)
    effect = np.sqrt(np.mean(exact**2, axis=(1, 2, 3, 4)))
    scale = dict(zip(space.paths, space.scale, strict=True))
    for path, size in zip(free, effect, strict=True):
        # an edge's radius moves the least
        idle = path in IDLE or path.startswith(BESIDE)
        assert (size == 0.0) if idle else (size * scale[path] > 1e-6 * base.chord), path
    # all at once, each by a share of its own of what moves the nets alike, so that none can be wrong unseen
    way = np.divide(np.random.default_rng(5).uniform(0.5, 1.0, len(free)), effect, out=0.0 * effect, where=effect > 0.0)
    step = 1e-4 * min(scale[path] / each for path, each in zip(free, way, strict=True) if each)
    moves = [{path: values[path] + by * step * each for path, each in zip(free, way, strict=True)} for by in (1, -1)]
    ahead, behind = np.moveaxis(np.stack(varied_nets(base, moves), axis=1), 0, 0)
    found, expected = (ahead - behind) / (2.0 * step), np.tensordot(way, exact, axes=1)
    # a wrong derivative of one of them misses by a thousand times as much
    assert np.sqrt(np.mean((found - expected) ** 2)) < LIMIT
    if at_limit:
        space = bw.variables(design, free=at_limit, knots=base.knots)
        found = step_studies(
            design, base, named_quantity(base, "surface"), space, steps=np.array([1e-4]), imaginary=IMAGINARY[:1]
        )
        assert [each.failure for each in found] == [""] * len(at_limit)


def test_a_fillets_radius_moves_strips_and_fillets_alone():
    design, base = coarse("marine-propeller")
    value, step, path = design.hub_fillet.radius, 1e-3 * design.hub_fillet.radius, "hub_fillet.radius"
    exact = bw.net_jacobian(design, free=[path], knots=base.knots).nets
    ahead, behind = (design.changed(path, value + by * step).build(knots=base.knots).surfaces for by in (1, -1))
    for name in ("upper", "lower"):
        assert not np.any(exact[name])
        for part in ("strip", "fillet"):
            nets = [each[f"hub_{part}_{name}"].control_points for each in (ahead, behind)]
            slope = (nets[0] - nets[1]) / (2.0 * step)
            assert np.max(np.abs(exact[f"hub_{part}_{name}"][0] - slope)) < 1e-4 * np.max(np.abs(slope))


def test_every_parameter_of_a_section_has_the_derivative_that_differences_give():
    found = swept("turbine-section", "surface", steps=np.array([1e-3, 1e-4]), imaginary=np.array([1e-20]))
    assert [each.failure for each in found if each.failure] == []
    assert {each.path for each in found if each.note} == IDLE


@pytest.mark.slow
@pytest.mark.parametrize("name", UNIFIED)
def test_differences_are_a_v_above_the_flat_floor_of_the_complex_step(name):
    for each in swept(name, "surface"):
        if each.note or each.path.startswith(BESIDE):
            continue
        assert not each.failure
        small = each.imaginary < 1e-9
        # flat at rounding for twenty decades, where differences have lost six digits and more
        assert each.floor[small].max() < 1e-12, each.path
        assert each.floor[small].max() < 0.1 * each.best, each.path
        # rounding over the step: tenfold a decade, in the mean of those where nothing else counts
        slope = np.polyfit(np.log10(each.steps[-4:]), np.log10(each.errors[-4:]), 1)[0]
        assert slope == pytest.approx(-1.0, abs=0.35), each.path


@pytest.mark.slow
@pytest.mark.parametrize("name", ["vki-ls89", "turbine-section"])
def test_area_and_throat_pass_the_check_as_well(name):
    section = isinstance(machine(name)[0], UnifiedSection)
    for quantity in ("area", "centroid") if section else ("area", "throat"):
        assert [each.failure for each in swept(name, quantity) if each.failure] == []


@pytest.mark.parametrize("name", BLADES)
def test_a_corner_of_the_channel_is_one_parameter(name):
    design = example(name)
    channel = design.channel
    points = sum(len(getattr(channel, curve)) for curve in ("leading_edge", "trailing_edge", "hub", "shroud"))
    assert sum(path.startswith("channel.") for path in design.parameters()) == 2 * points


def test_a_parameter_beside_a_limit_is_checked_on_smaller_steps():
    # tangents end at 1: the largest steps of the sweep would pass it
    design = CASCADE.changed("tangent_in", 1.0 - 2e-4)
    base = design.build()
    space = bw.variables(design, free="tangent_in", knots=base.knots)
    (found,) = step_studies(design, base, named_quantity(base, "surface"), space)
    assert not found.failure
    assert found.steps.max() < STEPS.max()


def test_an_idle_parameter_and_one_that_is_not_finite_are_named(monkeypatch):
    design, base = CLEARED, CLEARED.build()
    quantity = named_quantity(base, "surface")
    space = bw.variables(design, free=["stagger[0]", "stagger[1]", "stagger[2]"], knots=base.knots)

    def carried(design, base, paths):
        true = check_stepped(design, base, paths)
        yield base
        side = next(true).surfaces["upper"].control_points
        broken = type("Broken", (), {"sides": [_Net(side * np.nan), _Net(side)]})
        yield broken
        next(true)
        yield next(true)

    check_stepped = step_study.stepped
    monkeypatch.setattr(step_study, "stepped", carried)
    with np.errstate(invalid="ignore"):
        idle, broken, right = step_studies(
            design, base, quantity, space, steps=np.array([1e-4]), imaginary=IMAGINARY[:1]
        )
    assert idle.failure == "stagger[0] has no effect on the surface"
    assert broken.failure == "stagger[1]: the derivative of the surface is not finite"
    assert not right.failure
    assert right.best < LIMIT


class _Net:
    def __init__(self, control_points):
        self.control_points = control_points


def test_an_unknown_quantity_is_refused_with_the_nearest():
    _, base = machine("vki-ls89")
    with pytest.raises(DerivativeError, match="did you mean 'throat'"):
        named_quantity(base, "throt")


def test_complex_steps_that_cannot_be_built_are_left_out():
    design = design_from(tomllib.loads(template_text("turbine-vane")), "turbine-vane.toml")
    base = design.build()
    space = bw.variables(design, free=["stacking.line.points[0].x"], knots=base.knots)
    [study] = step_studies(design, base, named_quantity(base, "throat"), space, imaginary=np.array([1e-20, 1e-8, 0.1]))
    assert study.imaginary.tolist() == [1e-20, 1e-8]
    assert not study.failure
