"""gmsh, loaded where it is first used: importing this room does not need it."""

from typing import Any


class _Library:
    """The module gmsh, by attribute."""

    def __getattr__(self, name: str) -> Any:
        import gmsh

        return getattr(gmsh, name)


gmsh: Any = _Library()
