"""Files of one command that appear together in their directory, or not at all."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from bladewright.errors import FileError


@contextmanager
def staged(directory: Path) -> Iterator[Path]:
    """A directory to write into, whose files move to `directory` at the end; an error leaves nothing behind.

    `directory` is made where it is not there. Raises FileError where that is not possible.
    """
    made = [each for each in (directory, *directory.parents) if not each.exists()]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=".bladewright-", dir=directory))
    except FileExistsError:
        raise FileError(f"'{directory}' is a file: name a directory to write into") from None
    except OSError as error:
        _remove(made)
        reason = (error.strerror or str(error)).lower()
        raise FileError(f"nothing can be written into '{directory}': {reason}; name another directory") from error
    try:
        yield draft
        files = sorted(draft.iterdir())
        for each in files:
            if (directory / each.name).is_dir():
                raise FileError(f"'{directory / each.name}' is a directory where a file is to be written: move it away")
        for each in files:
            each.replace(directory / each.name)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
        _remove(made)


def _remove(made: list[Path]) -> None:
    """Remove what was made and stayed empty, the innermost first."""
    for each in made:
        with suppress(OSError):
            each.rmdir()
