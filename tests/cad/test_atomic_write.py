"""Files appear whole or not at all."""

import os
import signal
from pathlib import Path

import pytest

from bladewright import atomic_write as module
from bladewright import cad
from bladewright.atomic_write import atomic_write
from bladewright.cad import writing
from bladewright.errors import FileError

WAYS = ["_Nameless", "_Hidden"]


@pytest.fixture(params=WAYS)
def way(request, monkeypatch):
    """Both ways of holding an unfinished file, whatever the system offers."""
    if request.param == "_Hidden":
        monkeypatch.setattr(module._Nameless, "possible", staticmethod(lambda _: False))
    elif not module._Nameless.possible(Path.cwd()):
        pytest.skip("this system has no files without a name")
    return request.param


def killed(built, path):
    """How a process ends that kills itself when it has written all but the last of a file."""
    child = os.fork()
    if child == 0:
        put = writing._write_format

        def dying(made, body, unfinished, *arguments, **named):
            put(made, body, unfinished, *arguments, **named)
            if Path(unfinished).stat().st_size > 10_000:
                os.kill(os.getpid(), signal.SIGKILL)
            os._exit(1)

        writing._write_format = dying
        cad.write(built, path)
        os._exit(2)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.skipif(not hasattr(os, "O_TMPFILE"), reason="only Linux has files without a name")
@pytest.mark.parametrize("before", [None, "the old file"])
@pytest.mark.parametrize("ending", ["step", "igs", "brep"])
def test_a_process_killed_while_it_writes_leaves_nothing_new(bodies, tmp_path, ending, before):
    path = tmp_path / f"vane.{ending}"
    if before is not None:
        path.write_text(before)
    assert killed(bodies["linear"], path) == -signal.SIGKILL
    assert [name.name for name in tmp_path.iterdir()] == ([path.name] if before else [])
    if before is not None:
        assert path.read_text() == before


@pytest.mark.usefixtures("way")
def test_an_error_while_writing_leaves_the_old_file(tmp_path):
    path = tmp_path / "vane.step"
    path.write_text("old")

    def fail():
        with atomic_write(path) as unfinished:
            Path(unfinished).write_text("half of the n")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("way")
def test_a_file_appears_with_all_its_contents_and_the_usual_permissions(tmp_path):
    for text in ("first", "second"):
        with atomic_write(tmp_path / "a.txt") as unfinished:
            Path(unfinished).write_text(text)
        assert (tmp_path / "a.txt").read_text() == text
    (tmp_path / "b.txt").write_text("")
    assert (tmp_path / "a.txt").stat().st_mode == (tmp_path / "b.txt").stat().st_mode
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.usefixtures("way")
def test_what_a_link_points_to_is_replaced_and_the_link_stays(tmp_path):
    (tmp_path / "real").mkdir()
    target = tmp_path / "real" / "a.txt"
    target.write_text("old")
    link = tmp_path / "link.txt"
    link.symlink_to(target)
    with atomic_write(link) as unfinished:
        Path(unfinished).write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_a_directory_in_the_files_place_is_refused(bodies, tmp_path):
    (tmp_path / "vane.step").mkdir()
    with pytest.raises(FileError, match="is a directory: name the file"):
        cad.write(bodies["linear"], tmp_path / "vane.step")


def test_a_directory_that_does_not_exist_is_refused(bodies, tmp_path):
    with pytest.raises(FileError, match=r"cannot be written.*create the directory"):
        cad.write(bodies["linear"], tmp_path / "nowhere" / "vane.step")


@pytest.mark.parametrize("where", ["/proc/vane.step", "/sys/vane.igs"])
def test_a_directory_that_cannot_be_written_is_refused(bodies, where):
    if not Path(where).parent.is_dir():
        pytest.skip(f"this system has no {Path(where).parent}")
    with pytest.raises(FileError, match="cannot be written"):
        cad.write(bodies["linear"], where)


def test_a_full_disk_is_reported_and_leaves_nothing(bodies, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(module.os, "fsync", full)
    with pytest.raises(FileError, match=r"no space left on device; free some space"):
        cad.write(bodies["linear"], tmp_path / "vane.step")
    assert not list(tmp_path.iterdir())
