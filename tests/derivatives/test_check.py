"""Every derivative of every built-in example agrees with central differences; what is wrong is found."""

import tomllib
from functools import cache

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
from bladewright.section.unified import UnifiedSection
from machines.coarse import CASCADE, CLEARED

UNIFIED = [name for name in examples() if 'family = "unified' in example_text(name)]
BLADES = [name for name in UNIFIED if name != "turbine-section"]
IDLE = {"pitch", "span"}
"""which place the next blade, and make a solid of a section"""


@cache
def machine(name):
    design = machine_design(name)
    return design, design.build()


@cache
def coarse(name):
    """At few poles: the same parameters through the same steps."""
    design = machine_design(name).changed("tolerance", 1e-3)
    return design, design.build()


def machine_design(name):
    return design_from(tomllib.loads(example_text(name)), name)


def swept(name, quantity, **options):
    design, base = machine(name)
    space = bw.variables(design, knots=getattr(base, "knots", None))
    return list(step_studies(design, base, named_quantity(base, quantity), space, **options))


def misses(design, base, space, paths):
    """Errors of central differences of the nets near the bottom of their V, eight parameters in one rebuild."""
    values, scale = design.parameters(), dict(zip(space.paths, space.scale, strict=True))
    steps = np.array([1e-4 * scale[path] for path in paths])
    moves = [
        {path: values[path] + sign * step} for sign in (1.0, -1.0) for path, step in zip(paths, steps, strict=True)
    ]
    nets = np.stack(varied_nets(base, moves), axis=1)
    found = (nets[: len(paths)] - nets[len(paths) :]) / (2.0 * steps[:, None, None, None, None])
    exact = bw.net_jacobian(design, free=paths, knots=base.knots)
    exact = np.stack([exact.nets["upper"], exact.nets["lower"]], axis=1)
    each = tuple(range(1, 5))
    return np.sqrt(np.mean((found - exact) ** 2, axis=each)), np.sqrt(np.mean(exact**2, axis=each)) * steps * 1e4


@pytest.mark.parametrize("name", BLADES)
def test_every_parameter_of_every_blade_has_the_derivative_that_differences_give(name):
    design, base = coarse(name)
    space = bw.variables(design, knots=base.knots)
    # one that stands at its limit has its differences to one side
    at_limit = [path for path in space.paths if path.startswith("tangent") and design.parameters()[path] == 1.0]
    free = [path for path in space.paths if path not in at_limit]
    for first in range(0, len(free), 8):
        paths = free[first : first + 8]
        scale = np.array([space.scale[space.paths.index(path)] for path in paths])
        wrong, size = misses(design, base, space, paths)
        for path, error, effect in zip(paths, wrong * scale, size, strict=True):
            if path in IDLE:
                assert effect == 0.0
            else:
                # a wrong derivative misses by a thousand times as much, and an edge's radius moves the least
                assert error < LIMIT * effect, path
                assert effect > 1e-6 * base.chord, path
    if at_limit:
        space = bw.variables(design, free=at_limit, knots=base.knots)
        found = step_studies(
            design, base, named_quantity(base, "surface"), space, steps=np.array([1e-4]), imaginary=IMAGINARY[:1]
        )
        assert [each.failure for each in found] == [""] * len(at_limit)


def test_every_parameter_of_a_section_has_the_derivative_that_differences_give():
    found = swept("turbine-section", "surface", steps=np.array([1e-3, 1e-4]), imaginary=np.array([1e-20]))
    assert [each.failure for each in found if each.failure] == []
    assert {each.path for each in found if each.note} == IDLE


@pytest.mark.slow
@pytest.mark.parametrize("name", UNIFIED)
def test_differences_are_a_v_above_the_flat_floor_of_the_complex_step(name):
    for each in swept(name, "surface"):
        if each.note:
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
    design = machine_design(name)
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
