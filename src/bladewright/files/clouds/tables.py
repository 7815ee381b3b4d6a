"""Tables of numbers in text files, airfoil files among them."""

import io
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bladewright.errors import FileError
from bladewright.files.clouds.cloud import Columns
from bladewright.files.clouds.columns import role_named
from bladewright.nurbs.basis import Reals

COMMENTS = "#%!"
"""Characters that begin a comment."""
MOST_HEADER_LINES = 30
"""Most lines of words above the first row of numbers: a file with more is refused as prose. Tables have headers of a
few lines, so that the limit is generous."""
_FORTRAN_EXPONENT = re.compile(r"[0-9.][dD][-+]?\d")


class _Header(NamedTuple):
    """What stands above the first row of numbers."""

    lines: int
    """number of lines"""
    names: tuple[str, ...]
    """words of the last line, which may be column names"""
    row: str
    """the first row of numbers"""
    title: str
    """the first line that is no comment"""
    last_words: tuple[int, str]
    """number and text of the last line that is no comment"""


def read_table(path: Path, data: bytes) -> Columns:
    """The columns of numbers of a text file; raises FileError with line and column where it is no such table."""
    text = _decoded(path, data)
    head = _read_header(path, text)
    body = _normalised(text, head)
    try:
        values = np.loadtxt(io.StringIO(body), comments=None, skiprows=head.lines, ndmin=2)
    except ValueError as error:
        # numpy counts the rows with numbers, and does not say on which lines they are
        row = re.search(r"at row (\d+)", str(error))
        raise _refusal(path, body, head, int(row[1]) - 2 if row else 0) from None
    _check_header(path, head, values.shape[1])
    lines = _line_numbers(body, head, len(values))
    names = head.names if len(head.names) == values.shape[1] else ()
    whole = _are_whole(values[:, 0], head.row)
    if values.shape[1] != 2 or any(role_named(name) != "skip" for name in names):
        return Columns(values=values, format="a table", names=names, lines=lines, whole=whole)
    kind, start = airfoil_layout(values, head.title)
    return Columns(values=values[start:], format=kind, lines=lines[start:], columns=("x", "y"))


def _decoded(path: Path, data: bytes) -> str:
    if b"\0" in data:
        raise FileError(f"'{path}' is a binary file of no format that is known: give a table of numbers as text")
    data = data.removeprefix(b"\xef\xbb\xbf")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        # names and comments may be in any encoding; the digits are the same in all of them
        text = data.decode("latin-1")
    strange = sum(not (each.isprintable() or each.isspace()) for each in text[:4096])
    if strange > 0.02 * len(text[:4096]):
        raise FileError(f"'{path}' is a binary file of no format that is known: give a table of numbers as text")
    return text


def _read_header(path: Path, text: str) -> _Header:
    """The lines above the numbers, which begin with the first line whose words are all numbers."""
    names: tuple[str, ...] = ()
    title, last_words, words = "", (0, ""), 0
    for place, line in enumerate(io.StringIO(text)):
        bare = line.strip()
        comment = bare[:1] in COMMENTS and bare != ""
        row = _split(re.split(f"[{COMMENTS}]", bare)[0], ",;")
        counted = len(row) == 1 and row[0].isdigit()  # the number of rows, as some scanners put it above them
        if not comment and row and not counted and all(_is_number(word) for word in row):
            return _Header(place, names, bare, title, last_words)
        if not comment and bare:
            words += 1
            title, last_words = title or bare, (place + 1, bare)
        if bare:
            names = _names(bare.lstrip(COMMENTS)) or names
        if words > MOST_HEADER_LINES or place > 10_000:
            break
    first = next((line.strip() for line in io.StringIO(text) if line.strip()), "")
    shown = first if len(first) <= 60 else f"{first[:57]}..."
    raise FileError(f"'{path}' holds no rows of numbers: it begins with '{shown}', where coordinates are needed")


def _check_header(path: Path, head: _Header, count: int) -> None:
    """Raise FileError where the line above the numbers is a row with a word in it, not column names or a title."""
    place, line = head.last_words
    row = _split(line, ",;")
    if len(row) != count or not any(_is_number(word) and "." in word for word in row):
        return
    column, word = next((column, word) for column, word in enumerate(row, 1) if not _is_number(word))
    raise FileError(f"'{path}' has '{word[:40]}' at line {place}, column {column}: a number is needed")


def _names(line: str) -> tuple[str, ...]:
    """The column names of a line: in quotes, or separated by semicolons, commas or tabs, or else by blanks."""
    line = re.sub(r"(?i)^\s*variables\s*=", "", line).strip()
    if '"' in line:
        quoted = re.findall(r'"([^"]*)"', line)
        if quoted:
            return tuple(quoted)
    for sign in ";,\t":
        if sign in line:
            return tuple(word.strip() for word in line.split(sign))
    # a blank may separate a name from its unit: x [mm]
    return tuple(re.sub(r"\s+([\[(])", r"\1", line).split())


def _normalised(text: str, head: _Header) -> str:
    """The text with blanks between numbers, decimal points and no comments; the number of lines does not change."""
    decimal_comma = "," in head.row and (";" in head.row or ("." not in head.row and _commas_are_decimal(head.row)))
    if decimal_comma:
        text = text.translate(str.maketrans(",;", ". "))
    elif "," in text or ";" in text:
        if any(pair in text for pair in (",,", ";;", ", ,", "; ;", ",\t,", ";\t;")):
            text = re.sub(r"[,;](?=[ \t]*[,;])", " ? ", text)
        text = text.replace(",", " ").replace(";", " ")
    if '"' in head.row:
        text = text.replace('"', " ")
    if _FORTRAN_EXPONENT.search(head.row):
        text = text.translate(str.maketrans("dD", "ee"))
    if any(sign in text for sign in COMMENTS):
        text = re.sub(f"[{COMMENTS}][^\\n]*", "", text)
    return text


def _commas_are_decimal(row: str) -> bool:
    words = row.split()
    return len(words) > 1 and all(re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", word) for word in words)


def _split(line: str, signs: str) -> list[str]:
    signs += '"'
    return line.translate(str.maketrans(signs, " " * len(signs))).split()


def _is_number(word: str) -> bool:
    try:
        float(word.replace("D", "e").replace("d", "e"))
    except ValueError:
        return False
    return "_" not in word


def _are_whole(column: Reals, row: str) -> bool:
    first = _split(row, ",;")[0]
    return "." not in first and "e" not in first.lower() and bool(np.all(column == np.round(column)))


def _line_numbers(body: str, head: _Header, count: int) -> Reals:
    """Line (n,) in the file of each row."""
    if count == body.count("\n", 0, len(body.rstrip())) + 1 - head.lines:
        return np.arange(head.lines + 1.0, head.lines + 1.0 + count)
    rows = [place for place, line in enumerate(io.StringIO(body), 1) if place > head.lines and line.strip()]
    return np.array(rows[:count], dtype=np.float64)


def _refusal(path: Path, body: str, head: _Header, start: int) -> FileError:
    """The error of the first row from number `start` on that is no row of numbers."""
    counts = [len(words) for _, words in islice(_rows(body, head), 100)]
    usual = max(set(counts), key=counts.count)
    for place, words in _rows(body, head, start):
        wrong = _wrong(words, place, usual)
        if wrong:
            last = not body[_end_of(body, place) :].strip()
            cure = "it is the last line: is the file cut off?" if last else wrong[1]
            return FileError(f"'{path}' has {wrong[0]}{'; ' if last else ': '}{cure}")
    return FileError(f"'{path}' is no table of numbers")


def _rows(body: str, head: _Header, start: int = 0) -> Iterator[tuple[int, list[str]]]:
    """Line number and words of each row from number `start` on."""
    row = 0
    for place, line in enumerate(io.StringIO(body), 1):
        if place > head.lines and not line.isspace():
            if row >= start:
                yield place, line.split()
            row += 1


def _end_of(body: str, line: int) -> int:
    """Offset of the end of a line, given its number."""
    end = -1
    for _ in range(line):
        end = body.find("\n", end + 1)
        if end < 0:
            return len(body)
    return end


def _wrong(words: list[str], place: int, usual: int) -> tuple[str, str] | None:
    """What is wrong with a row, and how to correct it; None where nothing is."""
    try:
        _ = [float(word) for word in words]
        numbers = "_" not in "".join(words)
    except ValueError:
        numbers = False
    if not numbers:
        column, word = next((column, word) for column, word in enumerate(words, 1) if not _is_number(word))
        what = "an empty entry" if word == "?" else f"'{word[:40]}'"
        return f"{what} at line {place}, column {column}", "a number is needed"
    if len(words) != usual:
        return f"{len(words)} entries in line {place}, and {usual} in the others", "rows must have the same length"
    return None


def airfoil_layout(values: Reals, title: str) -> tuple[str, int]:
    """The layout of two columns (n, 2) below a title, in words, and the row in which their points begin.

    Below a title, a Selig file holds x y around the profile from the trailing edge; a Lednicer file holds the number of
    points of each side, then x y of both sides from the leading edge.
    """
    first = values[0]
    counted = bool(np.all(first == np.round(first)) and np.min(first) > 1.0 and first.sum() == len(values) - 1)
    if counted:
        return "a Lednicer airfoil", 1
    around = np.argmin(values[:, 0]) not in (0, len(values) - 1) and np.max(np.abs(values)) <= 2.0
    return ("a Selig airfoil" if title and around else "a table"), 0
