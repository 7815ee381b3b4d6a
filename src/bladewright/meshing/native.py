"""The text of gmsh's own mesh files, version 4.1: in another unit, or without its periodic motions."""

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

Lines = Iterator[str]


def rescaled(lines: Lines, scale: float) -> Lines:
    """The lines with entities and periodic motions scaled.

    gmsh itself scales the nodes, but leaves the boxes of its entities and the translations between periodic ones in the
    unit of the geometry.
    """
    for line in lines:
        yield line
        if line.startswith("$Entities"):
            yield from _entities(lines, scale)
        elif line.startswith("$Periodic"):
            yield from _motions(lines, scale)


def motionless(lines: Lines) -> Lines:
    """The lines without the periodic motions."""
    for line in lines:
        if line.startswith("$Periodic"):
            for each in lines:
                if each.startswith("$EndPeriodic"):
                    break
        else:
            yield line


def rewritten(path: Path, change: Callable[[Lines], Lines]) -> None:
    """Replace the lines of the file at a path by what `change` makes of them."""
    other = path.with_suffix(".rewritten")
    with path.open(encoding="utf-8") as source, other.open("w", encoding="utf-8") as target:
        target.writelines(change(source))
    other.replace(path)


def _entities(lines: Lines, scale: float) -> Lines:
    head = next(lines)
    yield head
    points, *others = map(int, head.split())
    yield from (_scaled(line, 1, 4, scale) for line in islice(lines, points))
    yield from (_scaled(line, 1, 7, scale) for line in islice(lines, sum(others)))


def _motions(lines: Lines, scale: float) -> Lines:
    head = next(lines)
    yield head
    for _ in range(int(head)):
        yield next(lines)
        words = next(lines).split()
        # the fourth column of a matrix by rows, after the count of its numbers
        for place in (4, 8, 12) if len(words) > 1 else ():
            words[place] = repr(float(words[place]) * scale)
        yield " ".join(words) + "\n"
        pairs = next(lines)
        yield pairs
        yield from islice(lines, int(pairs))


def _scaled(line: str, first: int, last: int, scale: float) -> str:
    words = line.split()
    words[first:last] = [repr(float(word) * scale) for word in words[first:last]]
    return " ".join(words) + "\n"
