"""A point cloud as it was read, and the columns of numbers that a file format gives before they become points."""

from dataclasses import dataclass

from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class Cloud:
    """The points of a file."""

    points: Reals
    """(n, 2) or (n, 3) in the order of the file: x y, or x y z [m]"""
    format: str
    """file format, in words"""
    unit: str
    """length unit that the file was read in"""
    columns: tuple[str, ...]
    """what each column of the file was read as, in order"""
    notes: tuple[str, ...] = ()
    """assumptions that were made, each a sentence"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """The columns of a file, before it is known which of them are coordinates."""

    values: Reals
    """(n, k)"""
    format: str
    """file format, in words"""
    names: tuple[str, ...] = ()
    """names of the columns, where the file gives them"""
    lines: Reals | None = None
    """(n,) line number of each row in a text file"""
    whole: bool = False
    """whether the whole first column is written without decimal points"""
    columns: tuple[str, ...] = ()
    """what the columns are, where the format itself defines it"""
    notes: tuple[str, ...] = ()
    """assumptions that were made, each a sentence"""
