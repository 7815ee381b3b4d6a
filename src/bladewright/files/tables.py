"""Tables of numbers in text files: commas between, names above the columns."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bladewright.designs import unknown
from bladewright.errors import FileError
from bladewright.nurbs.basis import Reals

Rows = list[list[str]]


def read_table(path: Path) -> tuple[list[str], Rows]:
    """The names of the columns, and the rows below; raises FileError where there is none, or rows differ in length."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            lines = csv.reader(stream, skipinitialspace=True)
            rows = [row for row in lines if row and not (len(row) == 1 and not row[0].strip())]
    except FileNotFoundError:
        raise FileError(f"there is no file '{path}'") from None
    except UnicodeDecodeError:
        raise FileError(f"'{path}' is no text: a table with commas between its numbers is needed") from None
    except (OSError, ValueError, csv.Error) as error:
        raise FileError(f"'{path}' cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(rows) < 2:
        raise FileError(f"'{path}' holds no rows: names of columns, and a row for each point below, are needed")
    header = [name.strip().strip('"') for name in rows[0]]
    for place, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise FileError(
                f"'{path}' has {len(row)} entries in row {place}, and {len(header)} columns: is it cut off?"
            )
    return header, rows[1:]


def columns(path: Path, header: Sequence[str], wanted: Sequence[str]) -> list[int]:
    """Places of wanted columns, whatever their case; raises FileError with the nearest name where one is not there."""
    known = {name.lower(): place for place, name in enumerate(header)}
    for name in wanted:
        if name.lower() not in known:
            raise FileError(unknown(f"'{path}': the column '{name}'", name, list(header)))
    return [known[name.lower()] for name in wanted]


def numbers(path: Path, rows: Rows, column: int) -> Reals:
    """A column (n,) as numbers; raises FileError with the row where one is none."""
    try:
        return np.array([float(row[column]) for row in rows])
    except ValueError:
        place = next(i for i, row in enumerate(rows) if not _is_number(row[column]))
        raise FileError(f"'{path}' has '{rows[place][column]}' in row {place + 2}: a number is needed") from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
