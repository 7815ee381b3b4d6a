"""Derivatives of what a search sees of a design, against central differences."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bladewright.blade.exact.cut_sectioned import exact_blade_of_sections
from bladewright.errors import DesignError
from bladewright.fitting.clouds.cloud import checked_cloud
from bladewright.fitting.free_parameters import FreeParameters
from bladewright.fitting.matching.footpoints import footpoints_at, nearest_footpoints
from bladewright.fitting.matching.search import Task, searched
from bladewright.fitting.models.designs import _flow_path_margins, _fold_margins
from bladewright.fitting.models.model import model_of
from machines import example
from machines.sectioned import BLUNT

NAMES = ("turbine-section", "compressor-stator")


@cache
def made(name):
    design = example(name)
    return design, model_of(design)


def cloud(name, count=60):
    _, model = made(name)
    sides = model.shape(made(name)[0]).sides
    random = np.random.default_rng(4)
    u, v = random.random((2, count))
    points = np.concatenate([side(u) if name == "turbine-section" else side(u, v) for side in sides])
    return points + 1e-3 * model.chord * random.normal(size=points.shape)


def differences(name, quantity):
    """Central differences (k, ...) of a quantity of the shape, by each parameter."""
    design, model = made(name)
    values = design.parameters()
    found = []
    for path in paths(name):
        step = 1e-5 * max(abs(values[path]), 1e-2)
        ends = [quantity(model.shape(design.changed(path, values[path] + sign * step))) for sign in (1.0, -1.0)]
        found.append((ends[0] - ends[1]) / (2.0 * step))
    return np.array(found)


def paths(name):
    """Every parameter of a section, and some of each field of a blade."""
    every = list(made(name)[0].parameters())
    if name == "turbine-section":
        return [path for path in every if path != "pitch"]
    return [path for path in every[::3] if not path.startswith("tip_")]


def along_axes(model, shape, on, names):
    """Derivatives (k, n, d) of footpoints by parameters."""
    axes = (np.broadcast_to(axis, on.points.shape) for axis in np.eye(on.points.shape[1]))
    return np.stack([model.along(shape, on, axis, names).T for axis in axes], axis=-1)


def scaled(rates):
    """The largest of each parameter's rates; 1 where it has no effect but rounding."""
    size = np.max(np.abs(rates.reshape(len(rates), -1)), axis=1)
    return np.where(size > 1e-9, size, 1.0).reshape(-1, *[1] * (rates.ndim - 1))


@pytest.mark.parametrize("name", NAMES)
def test_places_move_as_central_differences_say(name):
    design, model = made(name)
    shape = model.shape(design)
    on = nearest_footpoints(cloud(name), shape.sides)
    exact = along_axes(model, shape, on, paths(name))
    found = differences(name, lambda other: footpoints_at(on.points, other.sides, on.side, on.u, on.v).points)
    # rounding over the step, and the third derivative times its square
    np.testing.assert_allclose(found / scaled(exact), exact / scaled(exact), atol=3e-6)


@pytest.mark.parametrize("name", NAMES)
def test_noses_change_as_central_differences_say(name):
    design, model = made(name)
    excess, heights = model.edge_rates(model.shape(design), paths(name))
    laws = [i for i, path in enumerate(paths(name)) if not path.startswith("channel.")]
    for exact, values in ((excess, "edge_excess"), (heights, "edge_heights")):
        found = differences(name, lambda other, values=values: getattr(other, values))
        np.testing.assert_allclose((found / scaled(exact))[laws], (exact / scaled(exact))[laws], atol=3e-6)
    assert np.any(excess)


def test_folds_of_a_channel_change_as_central_differences_say():
    design, model = made("compressor-stator")
    shape = model.shape(design)
    exact = model.constraint_rates(shape, paths("compressor-stator"))
    # the median that they are a part of is held
    held = model.shape(design).exact

    def constraints(other):
        return np.real(_fold_margins(held, other.exact.channel))

    found = differences("compressor-stator", constraints)
    np.testing.assert_allclose(found / scaled(exact), exact / scaled(exact), atol=3e-6)
    assert np.all(shape.constraints < 0.0)


@pytest.mark.parametrize("matched", ["ends", "edges"])
def test_what_a_flow_path_refuses_changes_as_central_differences_say(matched):
    plain = example("backswept-impeller")
    design = replace(plain, flow_path=replace(plain.flow_path, matched=matched, quasi_orthogonals=()))
    model = model_of(design)
    shape, values = model.shape(design), design.parameters()
    names = [path for path in values if path.startswith(("flow_path.", "leading_edge.", "trailing_edge."))]
    count = len(_flow_path_margins(shape.exact, shape.exact))
    exact = model.constraint_rates(shape, names)[:, -count:]
    found = []
    for path in names:
        ends = [
            np.real(_flow_path_margins(shape.exact, exact_blade_of_sections(moved, model.knots, checked=False)))
            for moved in (design.changed(path, values[path] + step) for step in (1e-4, -1e-4))
        ]
        found.append((ends[0] - ends[1]) / 2e-4)
    np.testing.assert_allclose(np.array(found) / scaled(exact), exact / scaled(exact), atol=3e-6)
    assert np.all(shape.constraints < 0.0)
    assert np.all(np.any(exact != 0.0, axis=1))


def test_the_margins_of_a_flow_path_are_spent_before_it_is_refused():
    design = example("backswept-impeller")
    model = model_of(design)
    for path, ahead in (("flow_path.shroud.points[5].x", 10.0), ("leading_edge.control_points[0].r", 10.0)):
        value, least = design.parameters()[path], 0.0
        for share in np.linspace(0.3, 1.0, 29):
            try:
                shape = model.shape(design.changed(path, value + share * ahead))
            except DesignError:
                break
            least = float(np.max(shape.constraints))
        assert share < 1.0
        assert least > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_residuals_change_as_central_differences_say(name):
    """With feet found anew for each design: as they move along the surface only, to first order it does not matter."""
    design, _ = made(name)
    points = checked_cloud(cloud(name, 300))
    # no fit may free the span of a section
    free = FreeParameters(free=tuple(path for path in paths(name) if path != "span"))
    task = Task(points=points, weights=np.ones(len(points)), free=free, bounds={})
    problem = searched(task, design, rounds=1, noise=1e-3).problem
    z = problem.vector(design)
    exact, _ = problem.derivatives(z)
    random = np.random.default_rng(0)
    for _ in range(3):
        way, step = random.normal(size=len(z)), 1e-5
        ahead, behind = (problem.values(z + sign * step * way)[0] for sign in (1.0, -1.0))
        found = (ahead - behind) / (2.0 * step)
        count = len(points)
        # near an edge a foot may change sides, and the heights there are not smooth
        error = np.abs(found - exact @ way)[:count] / np.max(np.abs(found[:count]))
        assert np.percentile(error, 97.0) < 1e-4


def test_a_blade_with_a_blunt_edge_moves_as_central_differences_say():
    design = BLUNT
    model = model_of(design, 1e-7)
    shape, path = model.shape(design), next(path for path in design.parameters() if "metal_angle_in" in path)
    on = nearest_footpoints(shape.sides[0](*np.random.default_rng(4).random((2, 60))), shape.sides)
    ends = [
        footpoints_at(
            on.points, model.shape(design.changed(path, design.parameters()[path] + step)).sides, on.side, on.u, on.v
        ).points
        for step in (1e-4, -1e-4)
    ]
    rates = along_axes(model, shape, on, [path])[0]
    assert rates == pytest.approx((ends[0] - ends[1]) / 2e-4, abs=1e-5 * np.max(np.abs(rates)))
