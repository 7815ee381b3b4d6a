"""Fits of sections and blades whose deviations are known, without a search."""

from dataclasses import replace

import numpy as np

from bladewright.fitting.assessment.measurement import Estimate
from bladewright.fitting.assessment.result import Fit

from . import COARSE, built, example

DESIGNS = {
    "section": example("turbine-section"),
    "annular": example("fan-rotor").changed("tolerance", COARSE),
    "linear": example("vki-ls89").changed("tolerance", COARSE),
}


def made(kind, count=400, noise=1e-5, outliers=0.02, **changed):
    """A fit of points with a smooth deviation, noise and outliers; the cloud is where those deviations put it."""
    random = np.random.default_rng(2)
    design = DESIGNS[kind]
    shape = built(design)
    u, v = (1.0 - np.cos(np.pi * random.random(count))) / 2.0, random.random(count) * (kind != "section")
    places = np.where(random.random(count) < 0.5, "upper", "lower")
    deviations = 1.5e-5 * np.sin(9.0 * u) * np.cos(4.0 * v) + noise * random.standard_normal(count)
    inliers = np.ones(count, dtype=bool)
    inliers[random.choice(count, int(outliers * count), replace=False)] = False
    deviations[~inliers] *= 40.0
    fit = Fit(
        design=design,
        built=shape,
        cloud=cloud_of(shape, places, u, v, deviations) if kind == "section" else on_sides(shape, places, u, v),
        places=places,
        u=u,
        v=v,
        deviations=deviations,
        regions=np.where(u < 0.05, "leading edge", np.where(u > 0.95, "trailing edge", "sides")),
        inliers=inliers,
        set_aside=np.full(count, ""),
        estimates=(
            Estimate(path="stagger", value=1.0, deviation=0.1, low=0.8, high=1.2, identified=True, at_bound=False),
        ),
        covariance=np.eye(1),
        rank=1,
        condition=1.0,
        noise=noise,
        extrema={"upper": 1, "lower": 1},
        tolerance=5e-5,
        failures=(),
        notes=(),
        evaluations=1,
    )
    return replace(fit, **changed)


def cloud_of(section, places, u, v, deviations):
    del v
    points = np.zeros((len(u), 2))
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        own = places == name
        slope = section.curves[name].derivative(u[own])
        normal = sign * np.stack([-slope[:, 1], slope[:, 0]], axis=-1) / np.linalg.norm(slope, axis=1)[:, None]
        points[own] = section.curves[name](u[own]) + normal * deviations[own, None]
    return points


def on_sides(blade, places, u, v):
    """Points of the sides themselves."""
    return np.where((places == "upper")[:, None], blade.surfaces["upper"](u, v), blade.surfaces["lower"](u, v))
