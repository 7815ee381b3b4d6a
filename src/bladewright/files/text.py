"""Text files: read as UTF-8 within a limit of size, and written completely or not at all."""

import os
from pathlib import Path

from bladewright.atomic_write import atomic_write
from bladewright.errors import FileError

LARGEST = 1_000_000
"""[bytes] Size above which a text file is refused before it is read. A design file takes a few thousand, the
largest input file of T-Blade3 at hand 254,149."""

_SIGNATURES = {
    b"\x89PNG": "a PNG picture",
    b"PK\x03\x04": "a ZIP archive",
    b"\x1f\x8b": "a gzip archive",
    b"%PDF": "a PDF",
}
_UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_UTF_8_MARK = b"\xef\xbb\xbf"


def read_text(path: Path) -> str:
    """The text of a UTF-8 file of at most `LARGEST` bytes, with its line ends, without a byte-order mark.

    Raises FileError where there is no such file, or where it is a directory, too large, not text or not UTF-8.
    """
    try:
        with path.open("rb") as stream:
            size = os.fstat(stream.fileno()).st_size
            data = stream.read(LARGEST + 1) if size <= LARGEST else b""
    except FileNotFoundError:
        raise FileError(f"there is no file '{path}'{_suggestion(path)}") from None
    except IsADirectoryError:
        raise FileError(f"'{path}' is a directory: name a file in it{_designs_in(path)}") from None
    except (OSError, ValueError) as error:
        raise FileError(f"'{path}' cannot be read: {_reason(error)}") from error
    if max(size, len(data)) > LARGEST:
        problem = f"holds {size:,} bytes" if size > LARGEST else "does not end"
        raise FileError(f"'{path}' {problem}: at most {LARGEST:,} bytes are read; is it a design file?")
    return _decoded(data, path)


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8 with its line ends, completely or not at all.

    Raises FileError where it cannot be written, and then leaves nothing behind.
    """
    with atomic_write(path) as unfinished:
        Path(unfinished).write_bytes(text.encode())


def _decoded(data: bytes, path: Path) -> str:
    what = next((what for start, what in _SIGNATURES.items() if data.startswith(start)), None)
    if data.startswith(_UTF_16_MARKS):
        raise FileError(f"'{path}' is UTF-16 text: save it as UTF-8")
    if what or b"\0" in data:
        raise FileError(f"'{path}' is {what or 'a binary file'}: a design file is UTF-8 text")
    data = data.removeprefix(_UTF_8_MARK)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        place = f"byte 0x{data[error.start]:02x} at offset {error.start}, line {line}"
        guess = data[error.start : error.start + 1].decode("latin-1")
        cure = f"save it as UTF-8 (in latin-1 that byte is '{guess}')" if guess.isprintable() else "save it as UTF-8"
        raise FileError(f"'{path}' is not UTF-8 text: {place}; {cure}") from None


def _reason(error: OSError | ValueError) -> str:
    if isinstance(error, OSError) and error.strerror:
        return error.strerror[0].lower() + error.strerror[1:]
    return str(error)


def _suggestion(path: Path) -> str:
    from difflib import get_close_matches

    try:
        names = [each.name for each in path.parent.iterdir() if each.is_file()]
    except OSError:
        return f", nor a directory '{path.parent}'"
    near = get_close_matches(path.name, names, n=1, cutoff=0.5)
    designs = sorted(name for name in names if name.endswith(".toml")) if path.suffix in ("", ".toml") else []
    if near:
        return f"; did you mean '{path.with_name(near[0])}'?"
    return f"; design files there are {', '.join(designs[:5])}" if designs else ""


def _designs_in(path: Path) -> str:
    try:
        names = sorted(each.name for each in path.glob("*.toml"))
    except OSError:
        return ""
    return f", such as {names[0]}" if names else ""
