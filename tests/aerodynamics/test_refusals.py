"""What cannot be a polar ends in a paragraph: wrong numbers, and programs that are missing, hang, or are no XFOIL."""

import re
import shutil
import sys
import time

import pytest

import bladewright as bw
from bladewright.aerodynamics import untrapped
from bladewright.errors import PolarError

WRONG = {
    "alpha is not a number": ({"alpha": [float("nan")]}, "alpha has 1 angles from nan"),
    "no angle": ({"alpha": []}, "alpha has 0 angles: give 1 to 1000"),
    "an angle twice": ({"alpha": [1.0, 2.0, 1.0]}, "give each once"),
    "an angle behind": ({"alpha": 120.0}, "between -90 and 90"),
    "words": ({"alpha": "four"}, "give 1 to 1000 numbers"),
    "no flow": ({"reynolds": 0.0}, "Reynolds number by the chord is 0: it must lie between 1000 and 1e"),
    "not a number": ({"reynolds": float("nan")}, "Reynolds number by the chord is nan"),
    "transonic": ({"mach": 0.9}, "mach is 0.9: it must lie between 0 and 0.75"),
    "mach of a network": ({"mach": 0.2, "solver": "neuralfoil"}, "NeuralFoil knows incompressible flow only"),
    "another solver": ({"solver": "rans"}, "solver is 'rans': it must be 'xfoil' or 'neuralfoil'"),
    "n_crit": ({"n_crit": 0.0}, "n_crit is 0: it must lie between 0.5 and 18"),
    "forced transition": ({"transition": (1.0, 1.5)}, "forced transition of the lower side is 1.5"),
    "panels": ({"panels": 1000}, "panels is 1000: it must lie between 60 and 400"),
    "reference": ({"reference_length": -1.0}, "reference_length is -1 m"),
    "time": ({"time_limit": -1.0}, "time_limit is -1"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_numbers_are_refused_before_a_solver_starts(section, name, monkeypatch):
    monkeypatch.setattr("bladewright.aerodynamics.xfoil.subprocess.Popen", None)
    given, message = WRONG[name]
    with pytest.raises(PolarError, match=re.escape(message)):
        bw.polar(section, **{"reynolds": 1e6, "alpha": 4.0, **given})


def test_a_design_is_no_section(section):
    with pytest.raises(PolarError, match=r"asked of ProfileSection: give a section"):
        bw.polar(section.outline and bw.ProfileSection.__new__(bw.ProfileSection), 1e6, 0.0)


@pytest.mark.skipif(sys.platform == "win32", reason="the programs here are shell scripts")
@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("sleep 60", "no angle was done: XFOIL was stopped at the time limit of 0.3 s; raise it"),
        ("echo it broke; exit 3", "ended with status 3; its last words: it broke"),
        ("echo hello", "ended without a polar dump; its last words: hello"),
        ("kill -FPE $$", "stopped at a floating-point trap; set BLADEWRIGHT_XFOIL"),
        ("echo no dump at all > dump.bin", "no polar dump of version 6.9"),
    ],
)
def test_a_program_that_hangs_or_is_no_xfoil_is_told(section, script, message, tmp_path, monkeypatch):
    program = tmp_path / "solver"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("BLADEWRIGHT_XFOIL", str(program))
    monkeypatch.setattr(untrapped, "build_library", lambda: None)
    start = time.monotonic()
    with pytest.raises(PolarError, match=re.escape(message)):
        bw.polar(section, 1e6, 4.0, time_limit=0.3)
    assert time.monotonic() - start < 10.0


@pytest.mark.skipif(sys.platform == "win32", reason="the program here is a shell script")
@pytest.mark.usefixtures("xfoil")
def test_an_angle_at_which_xfoil_hangs_is_told_and_the_others_are_done(section, tmp_path, monkeypatch):
    program = tmp_path / "solver"
    program.write_text(
        f'#!/bin/sh\ncat > typed\ngrep -q "ALFA 7" typed && sleep 60\nexec {shutil.which("xfoil")} < typed\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("BLADEWRIGHT_XFOIL", str(program))
    monkeypatch.setattr("bladewright.aerodynamics.xfoil.PER_ANGLE", 0.1)
    monkeypatch.setattr("bladewright.aerodynamics.xfoil.HANGING", 0.005)
    polar = bw.polar(section, 1e6, [4.0, 7.0, 2.0])
    assert polar.converged.tolist() == [True, False, True]
    assert polar.failures == ("alpha 7: XFOIL hung, and was stopped after 0.6 s",)


def test_no_xfoil_and_a_wrong_name_for_it(section, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("BLADEWRIGHT_XFOIL", raising=False)
    with pytest.raises(PolarError, match=r"apt-get install xfoil.*BLADEWRIGHT_XFOIL.*neuralfoil"):
        bw.polar(section, 1e6, 4.0)
    monkeypatch.setenv("BLADEWRIGHT_XFOIL", "/no/xfoil")
    with pytest.raises(PolarError, match="BLADEWRIGHT_XFOIL is '/no/xfoil', which is no program"):
        bw.polar(section, 1e6, 4.0)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the library is for Linux")
def test_the_library_against_traps_is_built_whole_or_its_lack_is_told(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(untrapped, "COMPILERS", ("no-such-compiler",))
    with pytest.raises(PolarError, match=r"no C compiler here: install one \(apt-get install gcc\), or set"):
        untrapped.build_library()
    failing = tmp_path / "failing"
    failing.write_text("#!/bin/sh\necho no disc >&2; exit 1\n")
    failing.chmod(0o755)
    monkeypatch.setattr(untrapped, "COMPILERS", (str(failing),))
    with pytest.raises(PolarError, match=r"cannot be built as .*: no disc; or set"):
        untrapped.build_library()
    assert not untrapped.built()
    assert list(untrapped.library().parent.iterdir()) == []


def test_no_neuralfoil(section, monkeypatch):
    monkeypatch.setattr("bladewright.aerodynamics.neuralfoil.importlib.util.find_spec", lambda _: None)
    with pytest.raises(PolarError, match=r"pip install 'bladewright\[polar\]'"):
        bw.polar(section, 1e6, 4.0, solver="neuralfoil")
