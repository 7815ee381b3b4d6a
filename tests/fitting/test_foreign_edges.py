"""Blunt edges of a cloud whose design has round ones are said."""

import numpy as np
import pytest

import bladewright as bw
from bladewright.fitting.assessment.coverage import _arc, _face
from machines import example
from machines.sections import EXAMPLES

BASE = example("turbine-section")
RANDOM = np.random.default_rng(7)


def cloud(design):
    """Points of a section, a tenth of them at its trailing edge."""
    curves = design.build().curves
    counts = {"upper": 100, "lower": 100, "trailing_edge": 8}
    ends = [curves[side](1.0 - 0.01 * RANDOM.random(10)) for side in ("upper", "lower")]
    return np.concatenate([np.real(curve(RANDOM.random(counts[side]))) for side, curve in curves.items()] + ends)


def test_a_blunt_edge_is_said_with_its_width():
    design = EXAMPLES["naca-6409-blunt"].design
    face = design.build().curves["trailing_edge"]
    width = 1e3 * float(np.sqrt(np.sum((face(1.0) - face(0.0)) ** 2)))
    found = bw.fit(cloud(design), parameters=24)
    said = [note for note in found.notes if "is cut off" in note]
    assert len(said) == 1
    assert said[0].startswith(f"the trailing edge of the points is cut off, {width:.2g} mm wide")


def test_a_round_edge_is_not_called_blunt():
    assert not [note for note in bw.fit(cloud(BASE), BASE).notes if "is cut off" in note]


@pytest.mark.parametrize("width", [0.0, 0.3, 1.0])
def test_a_face_between_straight_sides_is_found_wherever_it_is_turned(width):
    behind, turn = np.linspace(0.05, 2.0, 12), 0.2
    across = np.linspace(-0.5, 0.5, 7) * width
    upper = np.stack([-behind, 0.5 * width + 0.1 * behind], axis=-1)
    lower = np.stack([-behind, -0.5 * width - 0.2 * behind], axis=-1)
    points = np.concatenate([upper, lower, np.stack([np.zeros(7), across], axis=-1)])
    along = np.cos(turn) * points[:, 0] - np.sin(turn) * points[:, 1]
    height = np.sin(turn) * points[:, 0] + np.cos(turn) * points[:, 1]
    found, left = _face(along + 3.0, height - 1.0)
    assert found == pytest.approx(width, abs=2e-3)
    assert left < 1e-6


@pytest.mark.parametrize("radius", [0.3, 1.0])
def test_an_arc_between_its_tangents_is_found(radius):
    turn, behind = np.array([0.3, -0.05]), np.linspace(0.0, 3.0, 12)
    angles = np.linspace(-0.5 * np.pi + turn[1], 0.5 * np.pi - turn[0], 9)
    points = [radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)]
    for sign, angle in zip((1.0, -1.0), turn, strict=True):
        normal, back = np.array([np.sin(angle), sign * np.cos(angle)]), np.array([-np.cos(angle), sign * np.sin(angle)])
        points.append(radius * normal + behind[:, None] * back)
    found = np.concatenate(points)
    assert _arc(found[:, 0] + 3.0, found[:, 1] - 1.0) < 1e-12
