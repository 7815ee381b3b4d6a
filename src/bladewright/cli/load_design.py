"""The design that a command is given, and the blade, section or passage that it builds."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from bladewright.errors import DesignError, FileError

BODIES = ("blade", "passage", "row", "sector", "wheel")
"""The bodies that a design is built into, as `--body` names them."""


def body_name(design: Any, body: str) -> str:
    """The name of a body of a design, which is that of its files."""
    return str(design.name) if body == "blade" else f"{design.name}-{body}"


def load_design(path: Path, changes: Mapping[str, Any]) -> Any:
    """Read the design in a file and apply the changes of `--set`."""
    from bladewright.files.changing import changed_design
    from bladewright.files.examples import examples
    from bladewright.files.reading import parsed
    from bladewright.files.text import read_text

    if not (path.exists() or path.with_suffix(".toml").exists()) and path.stem in examples():
        raise FileError(f"there is no file '{path}': 'bladewright new {path.stem}' writes the built-in example")
    return changed_design(parsed(read_text(path), str(path)), str(path), changes)


@contextmanager
def naming_file(path: Path) -> Iterator[None]:
    """Put the name of the design file in front of every DesignError that the block raises."""
    try:
        yield
    except DesignError as error:
        raise DesignError(f"{path}: {error}") from error


def built_from(design: Any, path: Path) -> Any:
    """What a design builds: a blade, or the section of a 2D design.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    with naming_file(path):
        return design.build()


def blade_from(design: Any, path: Path, *, fine: bool = False) -> Any:
    """The blade of a design, with `fine` as its `build` has it; of a 2D design, its prismatic blade.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.blade.design.families import prismatic

    with naming_file(path):
        return (prismatic(design) if design.dimension == 2 else design).build(fine=fine)


def bodies_from(
    bodies: Sequence[str],
    design: Any,
    path: Path,
    extend: float,
    extents: Mapping[str, Any],
    *,
    fine: bool = False,
    blades: int | None = None,
) -> Iterator[Any]:
    """The bodies of a design, each a word of BODIES, one after another around the same blade.

    The blade is extended past both ends by the part `extend` of its span; `extents` are the options of the passage;
    `fine` is that of `build`, `blades` the number of them in a row.
    Raises DesignError, naming the file at `path`, where a shape is impossible.
    """
    blade = blade_from(design, path, fine=fine)
    for body in bodies:
        with naming_file(path):
            made = _body_around(body, blade, design, extend, extents, blades)
            _ = made.surfaces  # they are made when asked for, and may be refused then
        yield made


def _body_around(
    body: str, blade: Any, design: Any, extend: float, extents: Mapping[str, Any], blades: int | None
) -> Any:
    import bladewright as bw

    if body == "passage":
        return _passage_around(blade, design, **extents)
    if body == "row":
        _check_pitch(design, "a row has neighbours")
        return bw.row(blade, blades)
    if body in {"sector", "wheel"}:
        return getattr(bw, body)(blade)
    return blade.extended(extend) if extend else blade


def passage_from(design: Any, path: Path, **extents: Any) -> Any:
    """The passage of a design; of a 2D design, the passage around its prismatic blade.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    blade = blade_from(design, path)
    with naming_file(path):
        return _passage_around(blade, design, **extents)


def flow_domain_from(design: Any, path: Path, extents: Mapping[str, Any]) -> Any:
    """The flow domain that `show` draws: the passage, or of a 2D unified design the curves around its section.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    if not design.has_planar_passage:
        return passage_from(design, path, **extents)
    from bladewright.domain.section import section_passage
    from bladewright.section.checks import UNITS

    if extents.get("split"):
        raise click.UsageError("--split cuts the faces of a passage: the curves around a 2D section have no creases")
    if design.pitch is None:
        raise DesignError(f"{path}: pitch is missing: a passage lies between neighbours; set pitch in the design")
    given = {name: value for name, value in extents.items() if name != "split" and value is not None}
    with naming_file(path):
        return section_passage(design.build(), design.pitch * UNITS[design.length_unit], **given)


def _passage_around(blade: Any, design: Any, *, split: bool = False, walls: str | None = None, **extents: Any) -> Any:
    from bladewright.domain.build import passage

    _check_pitch(design, "a passage lies between neighbours")
    given: Any = {} if walls is None else {"walls": walls}
    return passage(blade, split=split, **given, **extents)


def _check_pitch(design: Any, why: str) -> None:
    if design.dimension == 2 and design.pitch is None:
        raise DesignError(f"pitch is missing: {why}; set pitch in the design")
