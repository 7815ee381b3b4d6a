"""XFOIL's polar dump is read to its last digit, as far as it was written, and nothing else is taken for one."""

import struct

import numpy as np
import pytest

from bladewright.aerodynamics.xfoil_output import read_polar_dump
from bladewright.errors import PolarError
from machines.polars import DUMP


@pytest.fixture(scope="module")
def points():
    return read_polar_dump(DUMP)[1]


def test_coefficients_are_those_that_xfoil_printed(points):
    assert read_polar_dump(DUMP)[0] == "6.99"
    printed = {-2.0: (-0.0853, 0.00691, -0.0096, 0.4940, 0.0592), 4.0: (0.5765, 0.00593, -0.0071, 0.1839, 0.9336)}
    for point in points:
        cl, cd, cm, *transition = printed[point.alpha]
        assert point.cl == pytest.approx(cl, abs=5e-5)
        assert point.cd == pytest.approx(cd, abs=5e-6)
        assert point.cm == pytest.approx(cm, abs=5e-5)
        assert point.transition == pytest.approx(transition, abs=5e-5)


def test_pressure_around_the_outline_is_the_lift(points):
    for point in points:
        segments = point.flow.segments()
        assert np.sum(segments.lift_pressure) == pytest.approx(point.cl, abs=1e-6)


def test_the_flow_stagnates_once_and_friction_is_least_there(points):
    for point in points:
        flow = point.flow
        assert len(flow.x) == len(flow.cp) == len(flow.cf) == 160
        assert 0.98 < flow.cp[flow.stagnation - 1 : flow.stagnation + 1].max() <= 1.0
        assert np.max(flow.cp) <= 1.0


def test_a_dump_that_was_cut_off_keeps_the_points_that_are_whole(tmp_path, points):
    cut = tmp_path / "cut.dump"
    cut.write_bytes(DUMP.read_bytes()[:-100])
    assert [point.alpha for point in read_polar_dump(cut)[1]] == [point.alpha for point in points[:-1]]
    assert read_polar_dump(tmp_path / "none.dump") == ("", [])


def test_a_dump_of_four_byte_numbers_is_read_as_well(tmp_path, points):
    short = tmp_path / "short.dump"
    short.write_bytes(b"".join(_framed(_short(record, i)) for i, record in enumerate(_records(DUMP.read_bytes()))))
    for point, whole in zip(read_polar_dump(short)[1], points, strict=True):
        assert point.cl == pytest.approx(whole.cl, rel=1e-6)
        np.testing.assert_allclose(point.flow.cp, whole.flow.cp, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("content", [b"", b"alpha CL CD\n" * 20, struct.pack("<i", 8) * 40])
def test_another_file_is_no_polar_dump(tmp_path, content):
    (tmp_path / "other.dump").write_bytes(content)
    with pytest.raises(PolarError, match="no polar dump"):
        read_polar_dump(tmp_path / "other.dump")


def _records(data):
    place = 0
    while place < len(data):
        (size,) = struct.unpack_from("<i", data, place)
        yield data[place + 4 : place + 4 + size]
        place += 8 + size


def _short(record, number):
    """The record with its numbers in four bytes; some records are whole numbers, the first begins with text."""
    if number in {2, 3} or (number > 4 and (number - 5) % 4 == 1):
        return record
    text = record[:48] if number == 0 else b""
    return text + np.frombuffer(record[len(text) :], "<f8").astype("<f4").tobytes()


def _framed(record):
    return struct.pack("<i", len(record)) + record + struct.pack("<i", len(record))
