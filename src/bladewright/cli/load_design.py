"""The design that a command is given, and the blade, section or passage that it builds."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import click

from bladewright.designs import Design
from bladewright.errors import DesignError, FileError


def load_design(path: Path, changes: Mapping[str, Any]) -> Design:
    """The design in a file, with the changes of `--set`."""
    from bladewright.files.examples import examples
    from bladewright.files.reading import read_design

    if not (path.exists() or path.with_suffix(".toml").exists()) and path.stem in examples():
        raise FileError(f"there is no file '{path}': 'bladewright new {path.stem}' writes the built-in example")
    design = read_design(path)
    return design.changed(changes) if changes else design


@contextmanager
def naming_file(path: Path) -> Iterator[None]:
    """Name the design file at `path` in what is refused of its design."""
    try:
        yield
    except DesignError as error:
        raise DesignError(f"{path}: {error}") from error


def built_from(design: Any, path: Path) -> Any:
    """What a design builds: a blade, or a section of a 2D family.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    with naming_file(path):
        return design.build()


def blade_from(design: Any, path: Path) -> Any:
    """The blade of a design, a prismatic one where it is 2D.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.blade.design.families import prismatic
    from bladewright.section.planar import PlanarSection
    from bladewright.section.unified import UnifiedSection

    with naming_file(path):
        return (prismatic(design) if isinstance(design, UnifiedSection | PlanarSection) else design).build()


BODIES = ("blade", "passage")

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


def passage_options(command: Decorated) -> Decorated:
    """Let a command take the options of a passage; they come as the keywords of `passage_from`."""
    options = (
        click.option("--split", is_flag=True, help="Split a passage's faces where they have a crease."),
        click.option("--outlet-angle", type=float, metavar="DEG", help="Angle that a passage turns to at its outlet."),
        click.option("--inlet-angle", type=float, metavar="DEG", help="Angle that a passage turns to at its inlet."),
        click.option(
            "--downstream", type=float, metavar="X", help="Reach of a passage behind the blade, in meridional lengths."
        ),
        click.option(
            "--upstream", type=float, metavar="X", help="Reach of a passage before the blade, in meridional lengths."
        ),
    )
    for option in options:
        command = option(command)
    return command


def check_options(bodies: Sequence[str], extend: float, reach: Mapping[str, Any]) -> None:
    """Raise a usage error where an option is given for a body that is not asked for."""
    given = [f"--{name.replace('_', '-')}" for name, value in reach.items() if value not in {None, False}]
    if given and "passage" not in bodies:
        raise click.UsageError(f"{' and '.join(given)} shapes a passage: ask for one with --body passage")
    if extend and "blade" not in bodies:
        raise click.UsageError("--extend lengthens a blade: ask for one with --body blade")


def bodies_from(
    bodies: Sequence[str], design: Any, path: Path, extend: float, reach: Mapping[str, Any]
) -> Iterator[Any]:
    """The bodies of a design, of BODIES, one after another around one blade.

    A blade is extended past both ends by a part `extend` of its span, a passage has the options `reach`. Raises
    DesignError, naming the file at `path`, where a shape is impossible.
    """
    blade = blade_from(design, path)
    for body in bodies:
        if body == "passage":
            yield _passage_around(blade, design, path, **reach)
            continue
        with naming_file(path):
            long = blade.extended(extend) if extend else blade
        yield long


def passage_from(design: Any, path: Path, **reach: Any) -> Any:
    """The passage of a design, around a prismatic blade where it is 2D.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    return _passage_around(blade_from(design, path), design, path, **reach)


def _passage_around(blade: Any, design: Any, path: Path, *, split: bool = False, **reach: Any) -> Any:
    from bladewright.domain.build import passage

    with naming_file(path):
        if getattr(design, "pitch", 0.0) is None and getattr(design, "blade_count", None) is None:
            raise DesignError("pitch is missing: a passage lies between neighbours; set pitch in the design")
        return passage(blade, split=split, **reach)
