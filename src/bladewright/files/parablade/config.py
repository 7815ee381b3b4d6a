"""ParaBlade's configuration files: lines `KEY = value, value`."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from bladewright.errors import FileError

CHANNEL = ("x_leading", "y_leading", "z_leading", "x_trailing", "z_trailing", "x_hub", "z_hub", "x_shroud", "z_shroud")
COMMON = ("stagger", "theta_in", "theta_out", "radius_in", "radius_out")
UPPER = tuple(f"thickness_upper_{i}" for i in range(1, 7))
LOWER = tuple(f"thickness_lower_{i}" for i in range(1, 7))
CAMBER = ("dist_in", "dist_out", *UPPER, *LOWER)
ARCS = ("wedge_in", "wedge_out", "dist_1", "dist_2", "dist_3", "dist_4")
WORDS = (
    *("NDIM", "N_BLADES", "N_SECTIONS", "CASCADE_TYPE", "PARAMETRIZATION_TYPE", "OPERATION_TYPE", "PLOT_FORMAT"),
    *("PRESCRIBED_BLADE_FILENAME", "Config_Path"),
)
MAY_BE_EMPTY = ("x_hub", "z_hub", "x_shroud", "z_shroud")


@dataclass(frozen=True, kw_only=True)
class Config:
    """What a configuration file says of a blade."""

    dimensions: int
    blades: int
    sections: int
    annular: bool
    arcs: bool
    """whether the sides are connecting arcs, rather than camber and thickness"""
    laws: Mapping[str, tuple[float, ...]]
    """control points of each law, hub to shroud; lengths in metres, angles in degrees"""
    notes: tuple[str, ...]
    """remarks on lines that ParaBlade ignores or reads otherwise, each a sentence"""


def parsed(text: str, where: str) -> Config:
    """The configuration in a text; raises FileError, naming line or key, where it describes no blade."""
    entries, notes = _entries(text)

    def word(key: str, known: tuple[str, ...]) -> str:
        value = entries.get(key, [""])
        if len(value) != 1 or value[0].upper() not in known:
            state = f"is '{' '.join(value)}'" if key in entries else "is missing"
            raise FileError(f"{where}: {key} {state}: it must be one of {', '.join(known)}")
        return value[0].upper()

    def count(key: str, low: int) -> int:
        value = _numbers(where, key, entries.get(key, []))
        if len(value) != 1 or value[0] != round(value[0]) or value[0] < low:
            state = f"is '{' '.join(entries[key])}'" if key in entries else "is missing"
            raise FileError(f"{where}: {key} {state}: a whole number, at least {low}, is needed")
        return int(value[0])

    kind = word("PARAMETRIZATION_TYPE", ("CAMBER_THICKNESS", "CONNECTING_ARCS"))
    needed = (*CHANNEL, *COMMON, *(CAMBER if kind == "CAMBER_THICKNESS" else ARCS))
    laws = {}
    for key in needed:
        if key not in entries:
            raise FileError(f"{where}: {key} is missing, which {kind} needs: is the file cut off?")
        laws[key] = _numbers(where, key, entries[key])
        if not laws[key] and key not in MAY_BE_EMPTY:
            raise FileError(f"{where}: {key} is empty: give its control points from hub to shroud")
    _check_limits(where, laws)
    other = [key for key in entries if key not in {*CHANNEL, *COMMON, *CAMBER, *ARCS, *WORDS}]
    if other:
        notes.append(f"{_listed(other)} {'is' if len(other) == 1 else 'are'} no key of ParaBlade's geometry: ignored")
    dimensions = count("NDIM", 2)
    if dimensions > 3:
        raise FileError(f"{where}: NDIM is {dimensions}: it must be 2 or 3")
    return Config(
        dimensions=dimensions,
        blades=count("N_BLADES", 1) if "N_BLADES" in entries else 0,
        sections=count("N_SECTIONS", 2) if "N_SECTIONS" in entries else 2,
        annular=word("CASCADE_TYPE", ("LINEAR", "ANNULAR")) == "ANNULAR",
        arcs=kind == "CONNECTING_ARCS",
        laws=laws,
        notes=tuple(notes),
    )


def _entries(text: str) -> tuple[dict[str, list[str]], list[str]]:
    """The words of each key as ParaBlade reads them, and remarks on the lines that it ignores silently."""
    entries: dict[str, list[str]] = {}
    notes = []
    for place, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip()[0] in "#%":
            continue
        if line[0] in " \t":
            notes.append(
                f"line {place} begins with a blank, so ParaBlade passes over it, and so does this: '{_cut(line)}'"
            )
            continue
        key, sign, rest = line.partition("=")
        key = key.strip()
        if not sign:
            notes.append(f"line {place} has no '=' and is passed over: '{_cut(line)}'")
            continue
        rest, _, comment = rest.partition("#")
        if comment:
            notes.append(f"line {place} has a comment behind its value, which ParaBlade does not know: it is left out")
        if key in entries:
            notes.append(f"{key} stands there again at line {place}: the last one counts")
        entries[key] = [word for word in re.split(r"[\s,]+", rest.strip()) if word]
    return entries, notes


def _numbers(where: str, key: str, words: list[str]) -> tuple[float, ...]:
    values = []
    for word in words:
        try:
            value = float(word)
        except ValueError:
            raise FileError(f"{where}: {key} has '{word[:40]}' where a number is needed") from None
        if not math.isfinite(value):
            raise FileError(f"{where}: {key} has {word}: every number must be finite")
        values.append(value)
    return tuple(values)


def _check_limits(where: str, laws: Mapping[str, tuple[float, ...]]) -> None:
    limits = dict.fromkeys(
        ("stagger", "theta_in", "theta_out"), (-90.0, 90.0, "an angle must lie between -90 and 90 deg")
    )
    limits |= dict.fromkeys(("radius_in", "radius_out"), (0.0, 1.0, "an edge radius must lie between 0 and 1"))
    limits |= dict.fromkeys(("dist_in", "dist_out"), (0.0, 2.0, "a tangent must lie between 0 and 2"))
    for key, (low, high, what) in limits.items():
        for value in laws.get(key, ()):
            if not low < value < high:
                raise FileError(f"{where}: {key} has {value:g}: {what}")


def _cut(line: str) -> str:
    line = line.strip()
    return line if len(line) <= 40 else f"{line[:37]}..."


def _listed(keys: list[str]) -> str:
    return ", ".join(keys[:5]) + (f" and {len(keys) - 5} more" if len(keys) > 5 else "")
