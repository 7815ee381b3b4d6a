"""What the process that loads gmsh is told, and what it answers: two JSON files in one directory."""

from dataclasses import dataclass
from pathlib import Path
from typing import Self

from pydantic import TypeAdapter

ARRAYS = "arrays.npz"
"""name of the file beside them that holds what the mesh file holds"""
STEP = "@step "
"""what a line of the process's output begins with that says what it does"""


class Message:
    """A frozen record in a file that bears its type's name."""

    @classmethod
    def path(cls, directory: Path) -> Path:
        """The file in a directory."""
        return directory / f"{cls.__name__.lower()}.json"

    def put(self, directory: Path) -> None:
        """Write the record into a directory."""
        self.path(directory).write_bytes(TypeAdapter(type(self)).dump_json(self))

    @classmethod
    def taken(cls, directory: Path) -> Self:
        """The record in a directory."""
        return TypeAdapter(cls).validate_json(cls.path(directory).read_bytes())


@dataclass(frozen=True, kw_only=True)
class Near:
    """A curve or face that sizes grow away from."""

    face: str
    """name of the face; empty for a curve"""
    place: tuple[float, float, float]
    """middle of the curve [mm]"""
    size: float
    """[mm]"""


@dataclass(frozen=True, kw_only=True)
class Job(Message):
    """A mesh to make."""

    step: str
    """the STEP file, in millimetres"""
    faces: tuple[str, ...]
    """names of its faces, in the order of the shell"""
    motion: tuple[float, ...]
    """(16,) affine matrix from the lower to the upper periodic boundary, by rows [mm]"""
    largest: float
    """[mm]"""
    smallest: float
    """[mm]"""
    growth: float
    """[-]"""
    near: tuple[Near, ...]
    mesh: str
    """the file to write"""
    scale: float
    """of its unit in a millimetre"""


@dataclass(frozen=True, kw_only=True)
class Answer(Message):
    """How a mesh was made."""

    error: str = ""
    """why there is none"""
    gmsh: str = ""
    """version"""
    surface: tuple[str, ...] = ()
    """what meshed the faces"""
    volume: tuple[str, ...] = ()
    """what meshed the volume and improved it"""
    nodes: int = 0
    """that the mesh had before it was written"""
    tetrahedra: int = 0
