"""Derivatives of a passage: its nets forward and in reverse, and its volume, which a blade takes from a fixed ring."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.blade.native.properties import middle_of
from bladewright.derivatives.enclosed_volume import enclosed_volume_rates
from bladewright.errors import DerivativeError
from machines import COARSE, built, example
from machines.coarse import SECTION

FREE = {"vki-ls89": ["stagger", "thickness_upper[2]", "pitch"], "fan-rotor": ["tip_clearance", "stagger[2]"]}


@pytest.fixture(scope="module", params=list(FREE))
def machine(request):
    """A design, its blade and passage, and the Jacobian of the passage's nets."""
    name = request.param
    design = example(name).changed("tolerance", COARSE)
    blade = built(design)
    passage = bw.passage(blade)
    found = bw.net_jacobian(design, free=FREE[name], knots=blade.knots, of=bw.passage)
    return design, blade, passage, found


def test_every_untrimmed_face_has_its_derivatives(machine):
    _, _, passage, found = machine
    assert set(found.shapes) == {name for name in passage.surfaces if name != "tip"}
    for name, shape in found.shapes.items():
        assert shape.control_points.shape == passage.surfaces[name].control_points.shape
        assert np.isfinite(found.nets[name]).all()


def test_forward_and_reverse_agree_on_the_walls_too(machine):
    *_, found = machine
    random = np.random.default_rng(3)
    bars = {name: (*random.random((2, 8)), random.standard_normal((8, 3))) for name in ("hub_upper", "periodic_lower")}
    reverse = np.array(list(found.pulled_back(bars).values()))
    forward = sum(np.einsum("kid,id->k", found.points(name, u, v), bar) for name, (u, v, bar) in bars.items())
    assert reverse == pytest.approx(forward, abs=1e-12 * np.abs(forward).max())


def test_what_a_blade_gains_its_passage_loses(machine):
    # together they fill a part of the ring, or of the cascade, that only the pitch and the channel change
    design, blade, passage, found = machine
    volume = float(passage.properties.volume)
    middle, revolved = middle_of(blade.surfaces), blade.exact.mapping.revolved
    rates = enclosed_volume_rates(found, passage.orientations, volume, middle, revolved=revolved)
    gained = bw.sensitivity(design, lambda blade: blade.properties.volume, free=found.paths, knots=blade.knots)
    for path in found.paths:
        if path != "pitch":
            # walls, and the tip's surface under the blade, are met within a ten-millionth of the chord
            assert rates[path] == pytest.approx(-float(gained[path]), rel=1e-5), path


def test_the_volume_from_the_nets_is_that_of_the_complex_step():
    name = "vki-ls89"
    design = example(name).changed("tolerance", COARSE)
    blade = built(design)
    passage = bw.passage(blade)
    found = bw.net_jacobian(design, free="pitch", knots=blade.knots, of=bw.passage)
    volume = float(passage.properties.volume)
    rate = enclosed_volume_rates(found, passage.orientations, volume, middle_of(blade.surfaces), revolved=False)
    exact = bw.sensitivity(
        design,
        lambda blade: bw.passage(blade, knots=passage.knots).properties.volume,
        free="pitch",
        knots=blade.knots,
    )
    assert rate["pitch"] == pytest.approx(float(exact["pitch"]), rel=1e-9)
    # a larger pitch makes the passage wider by as much, from inlet to outlet
    area = float(exact["pitch"]) / 1e-3
    x = passage.surfaces["hub_upper"].control_points[:, 0, 0]
    assert area == pytest.approx(np.ptp(x) * np.ptp(passage.surfaces["inlet"].control_points[..., 2]), rel=1e-6)


def test_fluxes_that_do_not_add_up_are_refused(machine):
    _, blade, passage, found = machine
    revolved = blade.exact.mapping.revolved
    with pytest.raises(DerivativeError, match=r"take bladewright.sensitivity instead"):
        enclosed_volume_rates(found, passage.orientations, 1.0, middle_of(blade.surfaces), revolved=revolved)


def test_a_body_without_faces_is_refused():
    with pytest.raises(DerivativeError, match="a float has neither surfaces nor curves"):
        bw.net_jacobian(SECTION, of=lambda section: float(section.area))


@pytest.mark.parametrize(
    ("bars", "message"),
    [
        ({"uper": (0.5, 0.5, np.ones(2))}, "did you mean 'upper'"),
        ({"upper": (0.5, 0.5, np.ones(2))}, r"\(u, bar\) is needed"),
        ({"upper": (np.zeros(3), np.ones((2, 2)))}, r"bar has shape \(2, 2\): it must be that of the points, \(3, 2\)"),
        ({"upper": (np.zeros(2), np.full((2, 2), np.nan))}, "4 entries of bar are not finite"),
        ({"upper": (np.array([0.0, np.inf]), np.ones((2, 2)))}, "a parameter u or v is not finite"),
        ({"upper": (np.zeros(2), np.ones((2, 2)) * 1j)}, "bar is complex"),
    ],
)
def test_bars_that_make_no_sense_are_refused(bars, message):
    with pytest.raises(DerivativeError, match=message):
        bw.pullback(SECTION, bars)
