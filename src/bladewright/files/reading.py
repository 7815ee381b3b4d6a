"""Reading a design from a TOML file."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bladewright.designs import Design, unknown
from bladewright.errors import DesignError, FileError
from bladewright.files.families import FAMILIES
from bladewright.files.text import read_text
from bladewright.files.validation_messages import validation_messages


def read_design(path: str | PathLike[str]) -> Design:
    """The design in a TOML file; the `family` of the file decides its class.

    Raises FileError where the file cannot be read or is not TOML, and DesignError, naming file, parameter, value and
    limit, where it is no possible design.
    """
    path = Path(path)
    return design_from(parsed(read_text(path), str(path)), str(path))


def parsed(text: str, where: str) -> dict[str, Any]:
    """The tables of a TOML text; FileError with the line where it is not valid TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileError(f"'{where}' is not valid TOML: {_with_line(str(error), text)}") from error
    except (ValueError, RecursionError) as error:
        reason = "its lists are nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise FileError(f"'{where}' is not valid TOML: {reason}") from error


def design_from(document: Mapping[str, Any], where: str) -> Design:
    """The design in the tables of a file; `where` names the file in the DesignError."""
    document = dict(document)
    try:
        kind = _class_of(document.pop("family", None), document)
        return adapter(kind).validate_json(json.dumps(document, default=str), strict=True)
    except ValidationError as error:
        raise DesignError(f"{where}: {DesignError(*validation_messages(error, document, kind))}") from error
    except DesignError as error:
        raise DesignError(f"{where}: {error}") from error
    except RecursionError:
        raise DesignError(f"{where}: its lists are nested too deeply") from None


@cache
def adapter(kind: type[Design]) -> TypeAdapter[Design]:
    """Pydantic's validator for a design class."""
    return TypeAdapter(kind)


def _class_of(family: Any, document: Mapping[str, Any]) -> type[Design]:
    known = ", ".join(f'"{name}"' for name in FAMILIES)
    if family is None:
        near = next((key for key in document if key.lower().startswith("fam")), None)
        hint = f"; did you mean it by '{near}'?" if near else ""
        raise DesignError(f"family is missing: a design file says which family it is of, one of {known}{hint}")
    if not isinstance(family, str):
        raise DesignError(f"family is {json.dumps(family, default=str)}: a text is needed, one of {known}")
    if family not in FAMILIES:
        raise DesignError(unknown("family", family, list(FAMILIES)).replace("family does not exist: ", "family: "))
    return FAMILIES[family]


def _with_line(message: str, text: str) -> str:
    import re

    match = re.search(r"at line (\d+)", message)
    lines = text.splitlines()
    if match is None or not 0 < int(match[1]) <= len(lines):
        return message
    return f"{message}: {lines[int(match[1]) - 1].strip()[:80]}"
