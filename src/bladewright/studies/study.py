"""The file of a study: its designs, what it varies, what it looks at, and how it samples or searches."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, TypeAdapter, ValidationError

from bladewright.designs import Design
from bladewright.errors import FileError, StudyError
from bladewright.files.examples import examples
from bladewright.files.reading import design_from, parsed, read_design
from bladewright.files.text import read_text
from bladewright.studies.goals import Constraint, Objective, SearchOptions
from bladewright.studies.manifest import read_manifest
from bladewright.studies.operating_points import OperatingPoint, polar_figures
from bladewright.studies.quantities import Quantity, quantities_of
from bladewright.studies.variables import STRICT, Range, Variable, resolved

Sampling = Literal["grid", "list", "latin-hypercube", "sobol"]
Format = Literal["step", "iges", "brep", "stl", "3mf"]


@dataclass(frozen=True, kw_only=True)
class SweepOptions:
    """How a sweep samples: the table `[sweep]`."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT

    sampling: Sampling = "latin-hypercube"
    """how the values of the runs are chosen"""
    samples: Annotated[int, Field(ge=1, le=10_000_000)] = 64
    """number of runs of a Latin hypercube or a Sobol sequence"""
    seed: Annotated[int, Field(ge=0)] = 1
    """of its random numbers: the same seed gives the same runs"""
    table: str | None = None
    """a CSV file with a line for every run under the names of the variables, in the place of sampling"""
    quantities: tuple[str, ...] = ()
    """what is measured of every run"""
    files: tuple[Format, ...] = ()
    """CAD files that are written of every run"""
    time_limit: Annotated[float, Field(gt=0.0)] | None = None
    """longest time of a run [s]"""


@dataclass(frozen=True, kw_only=True)
class _File:
    """The keys of the file."""

    __pydantic_config__: ClassVar[Mapping[str, Any]] = STRICT
    design: str | None = None
    designs: dict[str, str] | None = None
    variables: dict[str, Range] = field(default_factory=dict)
    sweep: SweepOptions = field(default_factory=SweepOptions)
    optimise: SearchOptions | None = None
    polars: dict[str, OperatingPoint] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study as its file states it."""

    name: str
    """that of the file, without its ending"""
    folder: Path
    """of the file, from which it names others"""
    designs: Mapping[str, Design]
    """by name; that of the design itself where there is one"""
    ranges: Mapping[str, Range]
    """what is varied, by path or pattern"""
    sweep: SweepOptions = field(default_factory=SweepOptions)
    """how a sweep samples"""
    optimise: SearchOptions | None = None
    """how a search searches"""
    polars: Mapping[str, OperatingPoint] = field(default_factory=dict)
    """flows around sections, by name"""

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The variables; StudyError where one is of no design, or none is given."""
        return resolved(self.ranges, self.designs)

    def quantities(self, asked: object) -> list[Quantity]:
        """The quantities of a name, POINT.COEFFICIENT or MODULE:FUNCTION; StudyError where there is none."""
        found = polar_figures(asked, self.polars, self.designs) if isinstance(asked, str) else None
        return found or quantities_of(asked, self.designs, self.folder)


def read_study(path: str | PathLike[str]) -> Study:
    """The study in a TOML file, or that of the manifest of a sweep, a `.jsonl` file.

    Raises FileError where it or one of its designs cannot be read, DesignError where such a design is impossible, and
    StudyError, naming the file, the key, the value and what is needed, where it is no study.
    """
    path = Path(path)
    if path.suffix == ".jsonl":
        return _of_manifest(path)
    given = _checked(parsed(read_text(path), str(path)), path)
    files = given.designs or ({} if given.design is None else {"": given.design})
    if not files or (given.design and given.designs):
        what = "both design and [designs] are given: leave one out" if files else "design is missing: name its file"
        raise StudyError(f'{path}: {what}, as design = "vane.toml"')
    designs = {name: _design(path.parent / file, path) for name, file in files.items()}
    return Study(
        name=path.stem,
        folder=path.parent,
        designs={name or design.name: design for name, design in designs.items()},  # type: ignore[attr-defined]
        ranges=given.variables,
        sweep=given.sweep,
        optimise=given.optimise,
        polars=given.polars,
    )


def _of_manifest(path: Path) -> Study:
    """The study that the first line of a manifest states."""
    header, _ = read_manifest(path)
    if header.get("kind") != "sweep":
        raise StudyError(f"'{path}' is the manifest of a {header.get('kind', 'study')}, not of a sweep")
    texts = header["designs"]
    tables = {key: header.get(key, {}) for key in ("variables", "sweep", "polars")}
    given = _checked({"designs": texts, **tables}, path)
    return Study(
        name=path.stem,
        folder=Path(header["folder"]),
        designs={name: design_from(parsed(text, str(path)), str(path)) for name, text in texts.items()},
        ranges=given.variables,
        sweep=given.sweep,
        optimise=None,
        polars=given.polars,
    )


def _checked(document: Mapping[str, Any], path: Path) -> _File:
    try:
        return TypeAdapter(_File).validate_json(json.dumps(document, default=str), strict=True)
    except ValidationError as error:
        raise StudyError(f"{path}: {'; '.join(_messages(error))}") from error


def _design(file: Path, study: Path) -> Design:
    if not file.is_file() and file.stem in examples():
        raise FileError(
            f"{study}: there is no design '{file}': 'bladewright new {file.stem}' writes the built-in example"
        )
    try:
        return read_design(file)
    except FileError as error:
        raise FileError(f"{study}: design: {error}") from error


def _messages(error: ValidationError) -> list[str]:
    """A sentence for each key that is wrong."""
    found = []
    for each in error.errors(include_url=False):
        place = _path(each["loc"])
        if each["type"] == "unexpected_keyword_argument":
            found.append(_unknown_key(each["loc"]))
            continue
        needed = each["msg"].replace("Input should be ", "").replace("List should", "a list should")
        needed = needed.removeprefix("a valid ")
        found.append(f"{place} is {_shown(each['input'])}: {needed} is needed")
    return found


def _unknown_key(loc: tuple[int | str, ...]) -> str:
    *table, key = loc
    kinds: dict[str, Any] = {
        "sweep": SweepOptions,
        "variables": Range,
        "polars": OperatingPoint,
        "optimise": SearchOptions,
        "objectives": Objective,
        "constraints": Constraint,
    }
    kind = next((kinds[word] for word in reversed(table) if word in kinds), _File)
    known = [each.name for each in fields(kind)]
    near = get_close_matches(str(key), known, n=1, cutoff=0.5)
    hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
    return f"{_path(loc)} does not exist; {hint}"


def _path(loc: tuple[int | str, ...]) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in loc).lstrip(".")


def _shown(value: Any) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 60 else f"{text[:57]}..."
