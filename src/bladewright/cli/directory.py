"""The directory that a command writes into."""

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from bladewright.errors import FileError


@contextmanager
def removing_partial_files(directory: Path, names: Sequence[str]) -> Iterator[None]:
    """Run a block that writes these files into a directory; after an error, remove those that are new.

    A directory that does not exist is made, and removed again after an error. Raises FileError where it cannot be made
    or written into.
    """
    made = [each for each in (directory, *directory.parents) if not each.exists()]
    new: list[Path] = []
    try:
        _check_writable(directory, names)
        new = [directory / name for name in names if not (directory / name).exists()]
        yield
    except BaseException:
        for each in new:
            each.unlink(missing_ok=True)
        for each in made:
            with suppress(OSError):
                each.rmdir()
        raise


def _check_writable(directory: Path, names: Sequence[str]) -> None:
    """Raise FileError where the directory or one of the files cannot be written."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            pass
    except FileExistsError:
        raise FileError(f"'{directory}' is a file: name a directory to write into") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(f"nothing can be written into '{directory}': {reason}; name another directory") from error
    for name in names:
        if (directory / name).is_dir():
            raise FileError(f"'{directory / name}' is a directory where a file is to be written: move it away")
