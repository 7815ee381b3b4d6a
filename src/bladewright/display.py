"""How results show themselves: `plot()`, and picture and table in a notebook.

The rooms that make results do not know the one that draws. A result says by which name it is shown, and the package
says which module shows it (`drawn_by`); that is loaded when the first one is shown.
"""

from importlib import import_module

TYPE_CHECKING = False  # importing typing for it would cost a tenth of the package's start
if TYPE_CHECKING:
    from typing import Any, ClassVar, Protocol

    from matplotlib.figure import Figure

    class Drawing(Protocol):
        """The module that shows results."""

        def figure(self, shown: Any) -> Figure:
            """The figure of a result."""

        def html(self, shown: Any) -> str:
            """Picture and table of a result."""


_drawing = ""


def drawn_by(module: str) -> None:
    """Set the module that shows results, a `Drawing`."""
    global _drawing  # noqa: PLW0603 - set once, when the package is loaded
    _drawing = module


class Shown:
    """Base of results that are shown: `plot()` gives a figure, and a notebook shows picture and table."""

    __slots__ = ()
    shown_as: "ClassVar[str]"
    """name by which it is shown"""

    def plot(self) -> "Figure":
        """A matplotlib figure of it, as `bladewright show` draws it; pyplot does not know of it.

        A notebook shows it where it is the last line of a cell; `figure.savefig("blade.pdf")` writes it.
        """
        drawing: Drawing = import_module(_drawing)
        return drawing.figure(self)

    def _repr_html_(self) -> str:
        drawing: Drawing = import_module(_drawing)
        return drawing.html(self)
