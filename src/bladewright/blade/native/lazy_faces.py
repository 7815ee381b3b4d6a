"""Faces, and other parts of a blade, that are made when one is first used."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Generic, TypeVar

from bladewright.nurbs.surface import Surface
from bladewright.nurbs.trimmed import TrimmedSurface

Face = Surface | TrimmedSurface
Part = TypeVar("Part")


class LazyFaces(Mapping[str, Part], Generic[Part]):
    """A blade's sides, and its ends, which are made when one is first used; or its other parts by the same names."""

    def __init__(self, sides: Mapping[str, Part], names: Sequence[str], ends: Callable[[], Mapping[str, Part]]) -> None:
        self._found: dict[str, Part] = dict(sides)
        self._names, self._ends = tuple(names), ends

    def __getitem__(self, name: str) -> Part:
        if name not in self._found and name in self._names:
            self._found = {**self._ends(), **self._found}
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
