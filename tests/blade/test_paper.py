"""The paper's own mapping against angles measured on the published Rotor 67 of its authors."""

from pathlib import Path

import numpy as np
import pytest

from bladewright.blade.design.flow_path import Channel
from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.section.camber import camber_points

PUBLISHED = Path(__file__).parents[3] / "shared" / "data" / "clouds" / "NASA_R67.matched.cfg"
# parablade.md, section 5: the camber's angle to the meridional direction over 1.5 to 3 % and 97 to 98.5 % of the camber
MEASURED = {0.0: (42.9, -22.0), 0.5: (50.0, 29.7), 1.0: (56.1, 48.6)}


@pytest.fixture(scope="module")
def published():
    if not PUBLISHED.exists():
        pytest.skip(f"there is no {PUBLISHED}: the reference data is not beside the repository")
    pairs = (line.split("=") for line in PUBLISHED.read_text().splitlines() if "=" in line)
    words = {key.strip(): value for key, value in pairs}

    def numbers(key):
        return tuple(float(value) for value in words[key].split(",") if value.strip())

    def points(name):
        x, r = numbers(f"x_{name}"), numbers(f"z_{name}")
        count = max(len(x), len(r), 2)
        # a curve of fewer control points in one coordinate is the same Bezier curve of a higher degree
        return tuple(zip(_elevated(x, count), _elevated(r, count), strict=True))

    return UnifiedBlade(
        name="published",
        length_unit="m",
        blade_count=22,
        stagger=numbers("stagger"),
        metal_angle_in=numbers("theta_in"),
        metal_angle_out=numbers("theta_out"),
        tangent_in=numbers("dist_in"),
        tangent_out=numbers("dist_out"),
        leading_edge_radius=1e-4,
        trailing_edge_radius=1e-4,
        thickness_upper=(0.02,),
        thickness_lower=(0.02,),
        channel=Channel(
            leading_edge=points("leading"), trailing_edge=points("trailing"), hub=points("hub"), shroud=points("shroud")
        ),
        mapping="paper",
    )


def _elevated(values, count):
    values = np.array(values)
    while len(values) < count:
        n = len(values)
        share = np.arange(n + 1) / n
        values = share * np.append(0.0, values) + (1.0 - share) * np.append(values, 0.0)
    return tuple(values)


def angles(stations, window):
    """Mean angle [deg] of the mapped camber line to the meridional direction over a window of its parameter."""
    _, position, theta = stations.on_lines(camber_points(stations.plane.camber, np.array(window)))
    along = np.sqrt(np.sum(np.diff(position, axis=-2) ** 2, axis=-1))[:, 0]
    around = np.mean(position[..., 1], axis=-1) * np.diff(theta, axis=-1)[:, 0]
    return np.degrees(np.arctan2(around, along))


def test_the_papers_mapping_reproduces_the_angles_measured_on_its_rotor_67(published):
    stations = exact_unified_blade(published).sections(np.array(list(MEASURED)))
    found = np.stack([angles(stations, (0.015, 0.03)), angles(stations, (0.97, 0.985))], axis=-1)
    # measured to a tenth of a degree
    assert found == pytest.approx(np.array(list(MEASURED.values())), abs=0.1)


def test_the_conformal_mapping_turns_the_same_numbers_into_the_angles_they_name(published):
    design = published.changed("mapping", "conformal")
    v = np.array(list(MEASURED))
    stations = exact_unified_blade(design).sections(v)
    found = angles(stations, (0.0, 1e-5))
    assert found == pytest.approx(np.degrees(stations.metal_angles[0]), abs=1e-2)
