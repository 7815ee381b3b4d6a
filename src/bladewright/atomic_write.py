"""Files that appear whole or not at all, also when the process is killed while it writes."""

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from bladewright.errors import FileError


@contextmanager
def atomic_write(path: str | Path) -> Iterator[str]:
    """A path to write to; where the block ends well, what was written there becomes the file `path`.

    Where the system has files without a name (Linux), the unfinished file has none, so that nothing is left behind even
    by SIGKILL; elsewhere it is a hidden neighbour, removed on any exception. A link stays a link, a file keeps its
    permissions, and a device is written to directly. Raises FileError where `path` cannot be written.
    """
    try:
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise FileError(f"'{path}' is a directory: name the file to write in it")
        if target.exists() and not target.is_file():
            yield str(target)
            return
        unfinished = _Nameless(target) if _Nameless.possible(target.parent) else _Hidden(target)
    except (OSError, ValueError) as error:
        raise _refusal(path, error) from error
    try:
        yield unfinished.path
        unfinished.publish(_permissions(target))
    except OSError as error:
        raise _refusal(path, error) from error
    finally:
        unfinished.close()


def _refusal(path: str | Path, error: OSError | ValueError) -> FileError:
    reason = str(getattr(error, "strerror", None) or error)
    return FileError(f"'{path}' cannot be written: {reason[:1].lower()}{reason[1:]}; {_cure(Path(path), error)}")


def _permissions(target: Path) -> int:
    """Those of the file that is replaced, or what the process gives new files."""
    if target.exists():
        return target.stat().st_mode & 0o7777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _cure(target: Path, error: OSError | ValueError) -> str:
    with suppress(OSError, ValueError):
        if not target.parent.exists():
            return f"create the directory '{target.parent}' first"
        if not os.access(target.parent, os.W_OK):
            return f"the directory '{target.parent}' is not writable: name another file, or allow writing there"
    full = getattr(error, "errno", None) in {errno.ENOSPC, errno.EDQUOT}
    return "free some space there, or name another file" if full else "name another file"


class _Nameless:
    """A file without a name, which the system forgets with the process."""

    def __init__(self, target: Path) -> None:
        self.target = target
        self.descriptor = os.open(target.parent, os.O_TMPFILE | os.O_RDWR, 0o666)
        self.path = f"/proc/self/fd/{self.descriptor}"

    @staticmethod
    def possible(directory: Path) -> bool:
        if not (hasattr(os, "O_TMPFILE") and Path("/proc/self/fd").is_dir()):
            return False
        try:
            os.close(os.open(directory, os.O_TMPFILE | os.O_RDWR, 0o666))
        except OSError:
            return False
        return True

    def publish(self, permissions: int) -> None:
        os.fchmod(self.descriptor, permissions)
        os.fsync(self.descriptor)
        folder = os.open(self.target.parent, os.O_RDONLY)
        try:
            # with a descriptor of the directory Python calls linkat, which follows /proc/self/fd; link does not
            try:
                os.link(self.path, self.target.name, dst_dir_fd=folder, follow_symlinks=True)
            except FileExistsError:
                passing = f".{self.target.name}.{os.getpid()}"
                os.link(self.path, passing, dst_dir_fd=folder, follow_symlinks=True)
                os.replace(passing, self.target.name, src_dir_fd=folder, dst_dir_fd=folder)
            os.fsync(folder)
        finally:
            os.close(folder)

    def close(self) -> None:
        os.close(self.descriptor)


class _Hidden:
    """A hidden neighbour of the file."""

    def __init__(self, target: Path) -> None:
        self.target = target
        descriptor, self.path = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        os.close(descriptor)

    def publish(self, permissions: int) -> None:
        descriptor = os.open(self.path, os.O_RDWR)
        try:
            os.fchmod(descriptor, permissions)
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
        Path(self.path).replace(self.target)

    def close(self) -> None:
        with suppress(FileNotFoundError):
            Path(self.path).unlink()
