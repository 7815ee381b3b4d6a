"""The module gmsh, imported at the first use of one of its names, so that this room can be imported without it."""

from typing import Any


class _LazyModule:
    """Passes every attribute on to the module gmsh."""

    def __getattr__(self, name: str) -> Any:
        import gmsh

        return getattr(gmsh, name)


gmsh: Any = _LazyModule()
