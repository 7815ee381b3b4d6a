"""Reading a text file line by line, by the rules of Fortran's list-directed input."""

import math
import re
from pathlib import Path

from bladewright.errors import FileError

END = 1e-6
"""Largest deviation of the first and last span of a table from 0 and 1: the rounding of six digits."""
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdDqQ]([+-]?\d+)|([+-]\d+))?")
_REPEATED = re.compile(r"([1-9]\d{0,2})\*(.*)")


def list_directed_items(line: str) -> list[str | None]:
    """The values of a line: separated by blanks or commas, `3*0.5` for three of them, None for an empty one.

    A '/' ends the values. A value in quotes may contain separators.
    """
    found: list[str | None] = []
    after_comma = True
    for quoted, comma, slash, word in re.findall(r"""('[^']*'|"[^"]*")|(,)|(/)|([^\s,/'"][^\s,/]*)""", line):
        if slash:
            break
        if comma:
            if after_comma:
                found.append(None)
            after_comma = True
            continue
        after_comma = False
        repeated = _REPEATED.fullmatch(word)
        if quoted:
            found.append(quoted[1:-1])
        elif repeated:
            found.extend([repeated[2] or None] * int(repeated[1]))
        else:
            found.append(word)
    return found


def fortran_number(word: str | None) -> float | None:
    """The number that Fortran reads from a word, such as 1.5D-3, .5 or 1.5-3; None where it is no number."""
    match = _NUMBER.fullmatch(word or "")
    if not match:
        return None
    value = float(f"{match[1]}e{match[2] or match[3] or 0}")
    return value if math.isfinite(value) else None


class InputLines:
    """The lines of a file, read one after another; every error is a FileError that names file and line."""

    def __init__(self, text: str, path: Path) -> None:
        self.path = path
        # only these end a line, as in Fortran: a form feed is a blank
        self._lines = re.split(r"\r\n|\n|\r", text)
        if not self._lines[-1]:
            self._lines.pop()
        self._next = 0

    @property
    def place(self) -> int:
        """Number of the last line read, from 1."""
        return self._next

    @property
    def ended(self) -> bool:
        """Whether nothing but blank lines is left."""
        return not any(line.strip() for line in self._lines[self._next :])

    def error(self, message: str, place: int | None = None) -> FileError:
        """An error in the last line read, or in line number `place`."""
        return FileError(f"'{self.path}', line {self.place if place is None else place}: {message}")

    def text(self, what: str) -> str:
        """The next line, whatever it contains; `what` it should be is for the message where the file ends."""
        if self._next >= len(self._lines):
            raise self._cut_short(what)
        self._next += 1
        return self._lines[self._next - 1]

    def texts(self, count: int, what: str) -> str:
        """The last of the next `count` lines."""
        for _ in range(count - 1):
            self.text(what)
        return self.text(what)

    def peek(self) -> str:
        """The next line, without reading it; empty at the end of the file."""
        return self._lines[self._next] if self._next < len(self._lines) else ""

    def skip_blank(self) -> None:
        """Skip blank lines."""
        while self._next < len(self._lines) and not self.peek().strip():
            self._next += 1

    def skip_words(self, what: str) -> str:
        """Skip the lines before the next one that begins with a number; returns them, joined."""
        passed = []
        while not (found := list_directed_items(self.peek())) or fortran_number(found[0]) is None:
            passed.append(self.text(what))
        return "\n".join(passed)

    def words(self, what: str) -> list[str]:
        """The values of the next line that is not blank, as texts."""
        self.skip_blank()
        return [word or "" for word in list_directed_items(self.text(what))]

    def numbers(self, count: int, what: str, *, most: int | None = None) -> tuple[float, ...]:
        """The next `count` numbers, or up to `most` where the line has more; the rest of the line is ignored.

        They are on one line that is not blank, or fill several.
        """
        self.skip_blank()
        line = self.text(f"{what} ({_counted(count)})")
        first, found = self.place, list_directed_items(line)
        while len(found) < count:
            following = list_directed_items(self.peek())
            missing = count - len(found)
            if (
                not following
                or len(following) > missing
                or any(fortran_number(word) is None for word in (*found, *following))
            ):
                break
            found += following
            self._next += 1
        values = []
        for position, word in enumerate(found[: most or count], 1):
            value = fortran_number(word)
            if value is None:
                if position > count:
                    break
                raise self._no_number(word, line, what, count, first)
            values.append(value)
        if len(values) < count:
            holds = _counted(len(values)) if values else "nothing that can be read"
            raise self.error(f"{what} must be {_counted(count)}, and the line holds {holds}: '{_cut(line)}'", first)
        return tuple(values)

    def integers(self, count: int, what: str, *, least: int | None = None) -> tuple[int, ...]:
        """The next `count` whole numbers, the first of them at least `least`."""
        values = self.numbers(count, what)
        for value in values:
            if value != round(value):
                raise self.error(f"{what} is {value:g}: a whole number is needed")
        if least is not None and values[0] < least:
            raise self.error(f"{what} is {values[0]:g}: it must be at least {least}")
        return tuple(round(value) for value in values)

    def integer(self, what: str, *, least: int | None = None) -> int:
        """The next whole number."""
        return self.integers(1, what, least=least)[0]

    def rows(self, count: int, width: int, what: str) -> list[tuple[float, ...]]:
        """The next `count` lines of `width` numbers each."""
        return [self.numbers(width, f"row {row} of {count} of {what}") for row in range(1, count + 1)]

    def table(
        self, count: int, width: int, what: str, first: str = "span", *, equal: bool = False
    ) -> list[tuple[float, ...]]:
        """The next lines, the first number of which increases from 0 to 1; two inner ones may be `equal`."""
        found: list[tuple[float, ...]] = []
        for row in range(1, count + 1):
            found.append(self.numbers(width, f"row {row} of {count} of {what}"))
            value = found[-1][0]
            lone = equal and 2 < row < count and found[-3][0] < value
            if row > 1 and not (value > found[-2][0] or (lone and value == found[-2][0])):
                raise self.error(f"{first} of {what} is {value:g} after {found[-2][0]:g}: it must increase")
            for end, at in ((0.0, 1), (1.0, count)):
                if row == at and abs(value - end) > END:
                    which = "first" if end == 0.0 else "last"
                    raise self.error(f"{first} of {what} is {value:g} in the {which} row, where it must be {end:g}")
        return found

    def _no_number(self, word: str | None, line: str, what: str, count: int, place: int) -> FileError:
        if word is None:
            return self.error(f"{what} has an empty place between commas: {_counted(count)} must be given", place)
        return self.error(
            f"{what} must be {_counted(count)}, not '{_cut(line)}' ('{_cut(word)}' is no number): a count further up "
            "may differ from the lines that follow it, or a line be missing or too many",
            place,
        )

    def _cut_short(self, what: str) -> FileError:
        return FileError(
            f"'{self.path}' ends with line {len(self._lines)}, where {what} should follow: the file is cut short, or a "
            "count further up is too large"
        )


def _counted(count: int) -> str:
    return "a number" if count == 1 else f"{count} numbers"


def _cut(line: str) -> str:
    line = " ".join(line.split())
    return line if len(line) <= 50 else f"{line[:47]}..."
