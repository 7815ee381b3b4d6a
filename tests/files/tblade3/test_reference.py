"""T-Blade3's own cases: values of their sections are those that the program has computed from the same files."""

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from bladewright.files.tblade3 import is_tblade3, metal_angles, read_tblade3, section_spans, section_values

DATA = Path(__file__).parents[4] / "shared" / "data" / "tblade3"
CASES = sorted(path.name for path in DATA.iterdir() if path.is_dir()) if DATA.is_dir() else []
CLOSE = 1e-12
"""what is asked for; 16 digits are in the files, the largest difference found is 1.4e-14"""
needs_data = pytest.mark.skipif(not CASES, reason="the reference cases of T-Blade3 are not beside the repository")
each_case = pytest.mark.parametrize("name", CASES or [pytest.param("", marks=needs_data)])


class Reference:
    """A case, and what the program has written of it."""

    def __init__(self, name):
        (self.main,) = (DATA / name / "input").glob("3dbgbinput.*.dat")
        self.case = read_tblade3(self.main)
        self.folder = DATA / name / "output"
        edges = self.table("LE_TE_intersection.*")
        self.values = section_values(self.case, section_spans(edges[:, :2]))
        self.count = len(self.case.sections)

    def table(self, pattern, **options):
        found = sorted(self.folder.glob(pattern))
        return np.loadtxt(found[0], **options) if found else None

    @property
    def heads(self):
        """tan(beta) in and out, half chord, chord, pitch of each section."""
        files = [self.folder / f"blade.{i}.{self.case.row}.{self.case.name}" for i in range(1, self.count + 1)]
        return np.array([file.read_text().splitlines()[1].split() for file in files], dtype=float)

    def slopes(self):
        """Slopes phi (2, m) of the streamlines at the edges: x and r are splines of m', as in the program."""
        places = self.table("cascade_nondim.*", skiprows=4)[:, 1:3]
        found = []
        for line, edges in zip(self.case.streamlines, places, strict=True):
            points = np.array(line)
            step = np.diff(points, axis=0)
            length = np.cumsum(2.0 * np.sqrt(np.sum(step**2, axis=-1)) / (points[1:, 1] + points[:-1, 1]))
            ends = ([(2, np.zeros(2))], [(3, np.zeros(2))])
            x, r = make_interp_spline(np.append(0.0, length), points, k=3, bc_type=ends).derivative()(edges).T
            found.append(np.arctan(r / x))
        return np.array(found).T


@needs_data
def test_the_reference_cases_are_there():
    assert len(CASES) >= 6


@each_case
def test_a_case_of_the_program_is_read_whole(name):
    reference = Reference(name)
    assert is_tblade3(reference.main.read_text())
    assert len(reference.case.sections) == len(reference.case.streamlines) == reference.count
    assert reference.case.unsupported == ()
    walls = [reference.table(f"{wall}.*.sldcrv") for wall in ("hub", "casing")]
    for points, wall in zip((reference.case.streamlines[0], reference.case.streamlines[-1]), walls, strict=True):
        assert np.array(points) * reference.case.scale == pytest.approx(wall[:, [0, 2]], abs=1e-10)


@each_case
def test_control_points_of_meanlines_are_those_of_the_program(name):
    reference = Reference(name)
    expected = reference.table("curvature_span_variation.*")
    if expected is None:
        for i in range(1, reference.count + 1):
            points = reference.table(f"curvature_ctrl_pts.{i}.*", skiprows=3)
            assert (points is None) == (reference.values.meanlines is None)
            if points is not None:
                assert reference.values.meanlines[i - 1] == pytest.approx(points, abs=CLOSE)
        return
    found = np.array(reference.values.meanlines)
    assert np.hstack([found[..., 0], found[..., 1]]) == pytest.approx(expected[:, :-1], abs=CLOSE)


@each_case
def test_thicknesses_are_those_of_the_program(name):
    reference, values = Reference(name), Reference(name).values
    expected = reference.table("thickness_span_variation.*")
    if reference.case.thickness == "naca":
        columns = [values.span, values.leading_index, values.thickest, values.thickness, values.trailing_thickness]
        columns += [] if values.trailing_slope is None else [values.trailing_slope]
        assert np.column_stack(columns) == pytest.approx(expected, abs=CLOSE)
    elif expected is not None:
        assert np.column_stack([values.thickest, values.thickness]) == pytest.approx(expected, abs=CLOSE)
    for i, points in enumerate(values.multipliers or (), 1):
        program = reference.table(f"thick_Multi_cp.{i}.*", skiprows=1)
        assert points == pytest.approx(program[2:-2], abs=CLOSE)


@each_case
def test_thicknesses_of_the_edges_are_joints_of_the_quartic_spline_of_the_program(name):
    reference, values = Reference(name), Reference(name).values
    for i in range(reference.count):
        (file,) = list(reference.folder.glob(f"splthickness_tec.{i + 1}.*")) or [None]
        assert (file is None) == (not reference.case.thickness.startswith("quartic"))
        if file is not None:
            points = np.array([row.split()[:2] for row in file.read_text().splitlines()[2:13]], dtype=float)
            # where the segments of a uniform quartic B-spline meet
            joints = (points[:-3] + 11.0 * points[1:-2] + 11.0 * points[2:-1] + points[3:]) / 24.0
            assert 2.0 * joints[1, 1] == pytest.approx(values.leading_thickness[i], abs=CLOSE)
            assert 2.0 * joints[-2, 1] == pytest.approx(values.trailing_thickness[i], abs=CLOSE)
            assert joints[3] == pytest.approx([values.thickest[i], values.thickness[i] / 2.0], abs=CLOSE)


@each_case
def test_chords_and_pitch_are_those_of_the_program(name):
    reference = Reference(name)
    meridional = reference.table("cascade_nondim.*", skiprows=4)[:, 5]
    stagger = reference.table("stagger_angles.dat")
    chord = meridional * reference.values.chord_multiplier / np.cos(stagger)
    assert chord == pytest.approx(reference.heads[:, 3], abs=CLOSE)
    assert reference.heads[:, 4] == pytest.approx(2.0 * np.pi / reference.case.blade_count, abs=CLOSE)


@each_case
def test_metal_angles_are_those_of_the_program(name):
    reference = Reference(name)
    angles = metal_angles(reference.case, reference.values, *reference.slopes())
    assert np.tan(angles.inlet) == pytest.approx(reference.heads[:, 0], abs=CLOSE)
    assert np.tan(angles.exit) == pytest.approx(reference.heads[:, 1], abs=CLOSE)
    scalars = reference.folder / "section_scalars.txt"
    if scalars.exists():
        numbers = [float(line.split(":")[1]) for line in scalars.read_text().splitlines()]
        camber, _, inlet, _, stagger = np.array(numbers).reshape(-1, 5).T
        assert np.degrees(angles.camber) == pytest.approx(camber, abs=CLOSE)
        assert np.degrees(angles.inlet) == pytest.approx(inlet + stagger, abs=CLOSE)


@each_case
def test_sweep_and_lean_are_those_of_the_program_to_its_eight_digits(name):
    reference = Reference(name)
    rows = (reference.folder / f"blade_section_data.{reference.case.name}.dat").read_text().splitlines()
    table = [row.split() for row in rows if row.strip()[:1].isdigit()]
    found = np.array([[float(word) for word in row[7:9]] for row in table])
    assert np.column_stack([reference.values.sweep, reference.values.lean]) == pytest.approx(found, abs=6e-9)
    spans = np.array([float(row[1]) for row in table])
    assert reference.values.span == pytest.approx(spans, abs=6e-9)
