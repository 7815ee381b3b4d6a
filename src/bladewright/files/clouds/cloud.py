"""A cloud of points as it was read, and the numbers of a file before they are understood."""

from dataclasses import dataclass

from bladewright.nurbs.basis import Reals


@dataclass(frozen=True, kw_only=True, eq=False)
class Cloud:
    """Points that a file holds."""

    points: Reals
    """(n, 2) or (n, 3) in the order of the file: x y, or x y z [m]"""
    format: str
    """what the file is, in words"""
    unit: str
    """unit that its lengths were taken to be in"""
    columns: tuple[str, ...]
    """what its columns were taken for, in their order"""
    notes: tuple[str, ...] = ()
    """what was assumed, each a sentence"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """The columns of a file, as its format gives them."""

    values: Reals
    """(n, k)"""
    format: str
    names: tuple[str, ...] = ()
    """names of the columns, where the file has some"""
    lines: Reals | None = None
    """(n,) line of each row in the file, where it has lines"""
    whole: bool = False
    """whether the first column is written without decimal points throughout"""
    columns: tuple[str, ...] = ()
    """what the columns are, where the format itself says it"""
    notes: tuple[str, ...] = ()
