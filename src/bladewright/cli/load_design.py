"""The design that a command is given, and the blade, section or passage that it builds."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from bladewright.errors import DesignError, FileError

BODIES = ("blade", "passage")
"""The bodies that a design is built into, as `--body` names them."""


def load_design(path: Path, changes: Mapping[str, Any]) -> Any:
    """Read the design in a file and apply the changes of `--set`."""
    from bladewright.files.examples import examples
    from bladewright.files.reading import read_design

    if not (path.exists() or path.with_suffix(".toml").exists()) and path.stem in examples():
        raise FileError(f"there is no file '{path}': 'bladewright new {path.stem}' writes the built-in example")
    design = read_design(path)
    return design.changed(changes) if changes else design


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
    bodies: Sequence[str], design: Any, path: Path, extend: float, extents: Mapping[str, Any], *, fine: bool = False
) -> Iterator[Any]:
    """The bodies of a design, each a word of BODIES, one after another around the same blade.

    The blade is extended past both ends by the part `extend` of its span; `extents` are the options of the passage;
    `fine` is that of `build`.
    Raises DesignError, naming the file at `path`, where a shape is impossible.
    """
    blade = blade_from(design, path, fine=fine)
    for body in bodies:
        if body == "passage":
            yield _passage_around(blade, design, path, **extents)
            continue
        with naming_file(path):
            extended = blade.extended(extend) if extend else blade
        yield extended


def passage_from(design: Any, path: Path, **extents: Any) -> Any:
    """The passage of a design; of a 2D design, the passage around its prismatic blade.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    return _passage_around(blade_from(design, path), design, path, **extents)


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


def _passage_around(blade: Any, design: Any, path: Path, *, split: bool = False, **extents: Any) -> Any:
    from bladewright.domain.build import passage

    with naming_file(path):
        if design.dimension == 2 and design.pitch is None:
            raise DesignError("pitch is missing: a passage lies between neighbours; set pitch in the design")
        return passage(blade, split=split, **extents)
