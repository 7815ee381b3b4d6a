"""Options that several commands share, and how their values are read."""

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self, TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True, kw_only=True)
class Call:
    """The options that every command takes."""

    as_json: bool
    """print one JSON object on standard output, and nothing else"""
    quiet: bool
    """print nothing but errors and failures"""
    debug: bool
    """show the traceback of an error"""

    @classmethod
    def from_words(cls, words: Sequence[str]) -> Self:
        """Read the options off the words of a command line: they are needed even where the rest cannot be parsed."""
        return cls(as_json="--json" in words, quiet=not {"--quiet", "-q"}.isdisjoint(words), debug="--debug" in words)


def common(command: Command) -> Command:
    """Let a command take the options of `Call`."""
    return _with_options(
        command,
        click.option("--json", is_flag=True, expose_value=False, help="Print one JSON object, and nothing else."),
        click.option("-q", "--quiet", is_flag=True, expose_value=False, help="Print nothing but errors and failures."),
        click.option("--debug", is_flag=True, expose_value=False, help="Show the traceback of an error."),
    )


def passage_options(command: Command) -> Command:
    """Let a command take the options of a passage; they arrive as the keywords of `passage_from`."""
    return _with_options(
        command,
        click.option(
            "--upstream",
            type=float,
            metavar="X",
            help="Reach of a passage before the blade, in meridional lengths; without it to the flow path's end.",
        ),
        click.option(
            "--downstream",
            type=float,
            metavar="X",
            help="Reach of a passage behind the blade, in meridional lengths; without it to the flow path's end.",
        ),
        click.option("--inlet-angle", type=float, metavar="DEG", help="Angle that a passage turns to at its inlet."),
        click.option("--outlet-angle", type=float, metavar="DEG", help="Angle that a passage turns to at its outlet."),
        click.option(
            "--walls",
            type=click.Choice(["auto", "patches", "trimmed"]),
            help="A passage's hub and shroud: untrimmed patches, trimmed faces, or patches where they do not fold "
            "(auto, the rule).",
        ),
        click.option(
            "--split",
            is_flag=True,
            help="Cut a passage's faces where they have a crease; build cuts all faces as other CAD programs need it.",
        ),
    )


def check_options(
    bodies: Sequence[str], extend: float, extents: Mapping[str, Any], *, blades: int | None = None
) -> None:
    """Raise a usage error where an option is given for a body that is not asked for."""
    given = [f"--{name.replace('_', '-')}" for name, value in extents.items() if value not in {None, False}]
    if given and "passage" not in bodies:
        raise click.UsageError(f"{' and '.join(given)} shapes a passage: ask for one with --body passage")
    if extend and "blade" not in bodies:
        raise click.UsageError("--extend lengthens a blade: ask for one with --body blade")
    if blades is not None and "row" not in bodies:
        raise click.UsageError("--blades counts those of a row: ask for one with --body row")


def parse_length(_: click.Context, __: click.Parameter, text: str | None) -> float | None:
    """Convert a length such as 0.01mm to metres."""
    from bladewright.section.checks import UNITS

    if text is None:
        return None
    match = re.fullmatch(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*([a-z]+)\s*", text)
    try:
        value = float(match[1]) * UNITS[match[2]] if match else 0.0
    except (ValueError, KeyError):
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise click.BadParameter(f"'{text}' is not a length: write a positive number and its unit, like 0.01mm")
    return value


def parse_name(_: click.Context, __: click.Parameter, text: str | None) -> str | None:
    """Accept a name that files can have."""
    if text is not None and (not text.strip() or any(sign in text for sign in '/\\:*?"<>|')):
        raise click.BadParameter(
            f"'{text}' cannot be a design's name: it names files, so leave / \\ : * ? \" < > | out"
        )
    return text


def parse_colour(_: click.Context, __: click.Parameter, text: str) -> str:
    """Accept a colour such as #8899aa, or one of the words that `cad.write` takes in its place."""
    if text not in {"parts", "none"} and not re.fullmatch(r"#[0-9a-fA-F]{6}", text):
        raise click.BadParameter(f"'{text}' is no colour: write it like '#8899aa', or parts, or none")
    return text


def comma_separated(
    known: Sequence[str],
) -> Callable[[click.Context, click.Parameter, str | None], tuple[str, ...] | None]:
    """Return a callback that splits a list at its commas and accepts only known words."""

    def entries(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...] | None:
        if text is None:
            return None
        words = tuple(dict.fromkeys(word.strip().lower() for word in text.split(",")))
        for word in words:
            if word not in known:
                raise click.BadParameter(f"'{word}' is not one of {', '.join(known)}: write them with commas between")
        return words

    return entries


def _with_options(command: Command, *options: Callable[[Command], Command]) -> Command:
    """Decorate a command; its help lists the options in the order given."""
    for option in reversed(options):
        command = option(command)
    return command


def _parse_changes(_: click.Context, __: click.Parameter, pairs: Sequence[str]) -> dict[str, Any]:
    changes = {}
    for pair in pairs:
        path, sign, text = pair.partition("=")
        if not sign or not path.strip():
            raise click.BadParameter(f"'{pair}' is not PATH=VALUE: write it like --set stagger[1]=-52")
        changes[path.strip()] = _parse_value(path.strip(), text.strip())
    return changes


def _parse_value(path: str, text: str) -> Any:
    """Read a TOML value, or a word without quotation marks."""
    try:
        document = tomllib.loads(f"value = {text}\n")
    except (ValueError, RecursionError):
        document = {}
    if document.keys() == {"value"}:
        return document["value"]
    if re.fullmatch(r"[^\W\d][\w .-]*", text):
        return text
    raise click.BadParameter(f"'{text}' is no TOML value for {path}: a number, a list like [1.0, 2.0], or a \"text\"")


design_argument = click.argument("path", type=click.Path(path_type=Path), metavar="DESIGN")
set_option = click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="PATH=VALUE",
    callback=_parse_changes,
    help="Change a parameter, such as stagger[1]=-52 or channel.hub[0].x=3; the value is TOML. Repeatable.",
)
force_option = click.option("--force", is_flag=True, help="Overwrite a file that is there.")
fine_option = click.option(
    "--fine", is_flag=True, help="Let the blade meet hub and shroud within 1e-7 mm, with up to 1.7 times the poles."
)
blades_option = click.option(
    "--blades",
    type=click.IntRange(1, 10_000),
    metavar="N",
    help="Blades of a row; without it all, and a cascade, which has no end, needs it.",
)
extend_option = click.option(
    "--extend",
    type=click.FloatRange(0.0, 0.5),
    default=0.0,
    metavar="SPAN",
    help="Extend the blade past hub and shroud by this part of its span, for a later cut in your CAD; a tip stays.",
)
