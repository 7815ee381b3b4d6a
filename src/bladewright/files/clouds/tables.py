"""Tables of numbers in text, whatever stands between them, above them and beside them."""

import io
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.airfoils import parted
from bladewright.files.clouds.cloud import Numbers
from bladewright.files.clouds.columns import role_named
from bladewright.nurbs.basis import Reals

COMMENTS = "#%!"
MOST_NAMES = 30
"""lines of text that may stand above the numbers"""
_FORTRAN = re.compile(r"[0-9.][dD][-+]?\d")


class _Head(NamedTuple):
    """What stands above the first row of numbers."""

    lines: int
    names: tuple[str, ...]
    row: str
    title: str


def read_table(path: Path, data: bytes) -> Numbers:
    """The numbers of a text file; raises FileError with line and column where it is no table of them."""
    text = _decoded(path, data)
    head = _head_of(path, text)
    body = _plain(text, head)
    try:
        values = np.loadtxt(io.StringIO(body), comments=None, skiprows=head.lines, ndmin=2)
    except ValueError:
        raise _refusal(path, body, head) from None
    lines = _lines_of(body, head, len(values))
    names = head.names if len(head.names) == values.shape[1] else ()
    whole = _whole(values[:, 0], head.row)
    if values.shape[1] != 2 or any(role_named(name) != "skip" for name in names):
        return Numbers(values=values, format="a table", names=names, lines=lines, whole=whole)
    kind, start = parted(values, head.title)
    return Numbers(values=values[start:], format=kind, lines=lines[start:], columns=("x", "y"))


def _decoded(path: Path, data: bytes) -> str:
    if b"\0" in data[:100_000]:
        raise FileError(f"'{path}' is a binary file of no format that is known: give a table of numbers as text")
    try:
        return data.removeprefix(b"\xef\xbb\xbf").decode("utf-8")
    except UnicodeDecodeError:
        # names and comments may be in any code; numbers are the same in all
        text = data.decode("latin-1")
    strange = sum(not (each.isprintable() or each.isspace()) for each in text[:4096])
    if strange > 0.02 * len(text[:4096]):
        raise FileError(f"'{path}' is a binary file of no format that is known: give a table of numbers as text")
    return text


def _head_of(path: Path, text: str) -> _Head:
    """The lines above the numbers; the first line of which every word is a number ends them."""
    names: tuple[str, ...] = ()
    title, words = "", 0
    for place, line in enumerate(io.StringIO(text)):
        bare = line.strip()
        comment = bare[:1] in COMMENTS and bare != ""
        row = _split(re.split(f"[{COMMENTS}]", bare)[0], ",;")
        counted = len(row) == 1 and row[0].isdigit()  # the number of rows, as some scanners put it above them
        if not comment and row and not counted and all(_is_number(word) for word in row):
            return _Head(place, names, bare, title)
        if not comment and bare:
            words += 1
            title = title or bare
        if bare:
            names = _names(bare.lstrip(COMMENTS)) or names
        if words > MOST_NAMES or place > 10_000:
            break
    first = next((line.strip() for line in io.StringIO(text) if line.strip()), "")
    shown = first if len(first) <= 60 else f"{first[:57]}..."
    raise FileError(f"'{path}' holds no rows of numbers: it begins with '{shown}', where coordinates are needed")


def _names(line: str) -> tuple[str, ...]:
    """Words of a line of names: between quotes, tabs, commas or semicolons, else blanks."""
    line = re.sub(r"(?i)^\s*variables\s*=", "", line).strip()
    if '"' in line:
        quoted = re.findall(r'"([^"]*)"', line)
        if quoted:
            return tuple(quoted)
    for sign in ";,\t":
        if sign in line:
            return tuple(word.strip() for word in line.split(sign))
    # a unit may stand apart from its name: x [mm]
    return tuple(re.sub(r"\s+([\[(])", r"\1", line).split())


def _plain(text: str, head: _Head) -> str:
    """The text with blanks between numbers and points in them, without comments; every line stays a line."""
    decimal_comma = "," in head.row and (";" in head.row or ("." not in head.row and _commas_are_decimal(head.row)))
    if decimal_comma:
        text = text.translate(str.maketrans(",;", ". "))
    elif "," in text or ";" in text:
        text = re.sub(r"[,;](?=[ \t]*[,;])", " ? ", text).translate(str.maketrans(",;", "  "))
    if _FORTRAN.search(head.row):
        text = text.translate(str.maketrans("dD", "ee"))
    if any(sign in text for sign in COMMENTS):
        text = re.sub(f"[{COMMENTS}][^\\n]*", "", text)
    return text


def _commas_are_decimal(row: str) -> bool:
    words = row.split()
    return len(words) > 1 and all(re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", word) for word in words)


def _split(line: str, signs: str) -> list[str]:
    return line.translate(str.maketrans(signs, " " * len(signs))).split()


def _is_number(word: str) -> bool:
    try:
        float(word.replace("D", "e").replace("d", "e"))
    except ValueError:
        return False
    return "_" not in word


def _whole(column: Reals, row: str) -> bool:
    first = _split(row, ",;")[0]
    return "." not in first and "e" not in first.lower() and bool(np.all(column == np.round(column)))


def _lines_of(body: str, head: _Head, count: int) -> Reals:
    """Line (n,) in the file of each row."""
    if count == body.count("\n", 0, len(body.rstrip())) + 1 - head.lines:
        return np.arange(head.lines + 1.0, head.lines + 1.0 + count)
    rows = [place for place, line in enumerate(io.StringIO(body), 1) if place > head.lines and line.strip()]
    return np.array(rows[:count], dtype=np.float64)


def _refusal(path: Path, body: str, head: _Head) -> FileError:
    """What is wrong with the first bad row."""
    rows = [(place, line.split()) for place, line in enumerate(io.StringIO(body), 1) if place > head.lines]
    rows = [(place, words) for place, words in rows if words]
    counts = [len(words) for _, words in rows[:100]]
    usual = max(set(counts), key=counts.count)
    for number, (place, words) in enumerate(rows):
        last = number == len(rows) - 1
        for column, word in enumerate(words, 1):
            if word == "?":
                return FileError(f"'{path}' has an empty entry at line {place}, column {column}: a number is needed")
            if not _is_number(word):
                cut = "; it is the last line: is the file cut off?" if last else ": a number is needed"
                return FileError(f"'{path}' has '{word[:40]}' at line {place}, column {column}{cut}")
        if len(words) != usual:
            cut = "; it is the last line: is the file cut off?" if last else ": rows must have the same length"
            return FileError(f"'{path}' has {len(words)} entries in line {place}, and {usual} in the others{cut}")
    return FileError(f"'{path}' is no table of numbers")
