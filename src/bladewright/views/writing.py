"""Picture files, written whole or not at all."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.backends.backend_agg import FigureCanvasAgg

from bladewright.appearing import appearing
from bladewright.errors import FileError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def checked(path: str | Path) -> Path:
    """The path, if a picture can be written there; raises FileError where its suffix or its directory will not do."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        kind = f"ends in '{path.suffix}'" if path.suffix else "has no ending"
        raise FileError(f"'{path}' {kind}: a picture is drawn as {', '.join(SUFFIXES)}; end its name in one of them")
    if path.is_dir():
        raise FileError(f"'{path}' is a directory: name the picture to write")
    if not path.parent.is_dir():
        raise FileError(f"'{path}' cannot be written: there is no directory '{path.parent}'; make it first")
    return path


def write(figure: "Figure", path: str | Path, dots: int) -> None:
    """Writes a figure as PNG, SVG or PDF by the path's suffix, `dots` to an inch; raises FileError if that fails.

    The same figure gives the same bytes, whenever it is written.
    """
    path = checked(path)
    suffix = path.suffix.lower()
    picture = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(picture, format=suffix[1:], dpi=dots, metadata=_UNDATED[suffix])
    with appearing(path) as unfinished:
        Path(unfinished).write_bytes(picture.getvalue())
