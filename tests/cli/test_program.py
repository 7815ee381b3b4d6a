"""The program itself: versions, help, exit statuses, standard streams."""

import importlib.metadata
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bladewright.cli import main
from bladewright.errors import DesignError

COMMANDS = ["build", "verify", "fit", "import", "mesh", "show", "new", "schema"]


def test_the_version_names_package_and_opencascade_without_loading_it():
    code = "import sys; from bladewright.cli import main; main(['--version']); print('OCP' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    kernel = ".".join(importlib.metadata.version("cadquery-ocp").split(".")[:3])
    version = importlib.metadata.version("bladewright")
    assert run.stdout.splitlines() == [f"bladewright {version} (OpenCASCADE {kernel})", "False"]


def test_help_loads_nothing_heavy():
    code = "import sys; from bladewright.cli import main; main(['--help']); print(sorted(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = run.stdout.splitlines()[-1]
    for heavy in ("numpy", "scipy", "pydantic", "matplotlib", "OCP", "tomlkit", "tqdm"):
        assert f"'{heavy}'" not in loaded


def test_help_lists_every_command(run):
    found = run("--help")
    assert found.status == 0
    for command in COMMANDS:
        assert f"\n  {command} " in found.out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_takes_the_common_options(command, run):
    found = run(command, "--help")
    assert found.status == 0
    for option in ("--json", "--quiet", "--debug"):
        assert option in found.out


def test_without_a_command_the_help_is_printed(run):
    assert "Commands:" in run().out


@pytest.mark.parametrize("other", [ImportError("a module failed"), SystemError("a call failed")])
def test_an_interrupt_that_a_library_makes_another_error_of_is_one(other, run, design_file, monkeypatch):
    def interrupted(*_, **__):
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as error:
            raise other from error

    monkeypatch.setattr("bladewright.cli.build_files.bodies_from", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    found = run("build", design_file, "-o", design_file.parent / "out")
    assert signal.signal(signal.SIGINT, before) is signal.default_int_handler
    assert found.status == 130
    assert "interrupted" in found.err
    assert run("build", design_file.parent / "none.toml").status == 2


def test_an_interruption_ends_with_130_and_leaves_nothing(run, design_file, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bladewright.cli.build_files.bodies_from", interrupted)
    found = run("build", design_file, "-o", design_file.parent / "out")
    assert (found.status, found.err.strip()) == (130, "bladewright: interrupted")
    assert list(design_file.parent.iterdir()) == [design_file]


def test_an_unforeseen_error_is_a_paragraph_and_a_traceback_with_debug(run, design_file, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("division\nby zero")

    monkeypatch.setattr("bladewright.cli.show.built_from", broken)
    found = run("show", design_file)
    assert found.status == 2
    assert found.err.count("\n") == 1
    assert "division by zero" in found.err
    assert "--debug" in found.err
    assert "Traceback" in run("show", design_file, "--debug").err


def test_an_error_of_the_input_shows_its_traceback_with_debug_only(run, design_file, monkeypatch):
    def refused(*_):
        raise DesignError("too thin")

    monkeypatch.setattr("bladewright.cli.show.built_from", refused)
    assert run("show", design_file).err == "bladewright: too thin\n"
    assert "Traceback" in run("show", design_file, "--debug").err


def test_a_reader_that_has_had_enough_ends_nothing_with_an_error():
    read, write = os.pipe()
    os.close(read)
    run = subprocess.run(
        [sys.executable, "-m", "bladewright", "new"], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_disk_behind_standard_output_is_an_error():
    with Path("/dev/full").open("w") as full:
        run = subprocess.run(
            [sys.executable, "-m", "bladewright", "new"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert run.returncode == 2
    assert "no space left" in run.stderr.lower()
    assert "Traceback" not in run.stderr


def test_the_interrupt_signal_ends_a_build_with_130_and_leaves_nothing(design_file):
    out = design_file.parent / "out"
    words = [sys.executable, "-m", "bladewright", "build", design_file, "-o", out]
    # a suite that runs in the background of a shell ignores the signal, and what it starts would too
    kept = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    finally:
        signal.signal(signal.SIGINT, kept)
    while not out.exists() and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    # amid a class that is being made, Python ends itself by the signal, which a shell calls 130 as well
    assert process.returncode in (130, -signal.SIGINT), stderr
    assert stdout == ""
    assert stderr.strip() == "bladewright: interrupted"
    assert list(design_file.parent.iterdir()) == [design_file]


def test_main_reads_the_words_of_the_process(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["bladewright", "new", "--json"])
    assert main() == 0
    assert "fan-rotor" in json.loads(capsys.readouterr().out)["examples"]
