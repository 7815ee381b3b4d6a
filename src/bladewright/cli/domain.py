"""The bodies that a design is made into: its blade, and the passage around it with the options of that."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from bladewright.cli.blueprint import body_from
from bladewright.errors import DesignError

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


def named_body(body: str, design: Any, path: Path, extend: float, reach: Mapping[str, Any]) -> Any:
    """The blade of a design, or its passage. Raises DesignError where the shape is impossible."""
    return passage_from(design, path, **reach) if body == "passage" else body_from(design, path, extend)


def passage_from(design: Any, path: Path, *, split: bool = False, **reach: Any) -> Any:
    """The passage of a design, around a prismatic blade where it is 2D.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.domain.build import passage

    if getattr(design, "pitch", 0.0) is None and getattr(design, "blade_count", None) is None:
        raise DesignError(f"{path}: pitch is missing: a passage lies between neighbours; set pitch in the design")
    blade = body_from(design, path, 0.0)
    try:
        return passage(blade, split=split, **reach)
    except DesignError as error:
        raise DesignError(f"{path}: {error}") from error
