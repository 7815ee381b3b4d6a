"""Reading a ParaBlade configuration as a design, with what was changed and how far it lies from ParaBlade's blade."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from bladewright.blade.design.unified import UnifiedBlade
from bladewright.blade.exact.unified import exact_unified_blade
from bladewright.errors import DesignError, FileError
from bladewright.files.imported import Imported, most_blades_apart
from bladewright.files.parablade.config import CHANNEL, COMMON, WORDS, Config, parsed
from bladewright.files.parablade.sections import sections_at, side_basis
from bladewright.files.parablade.translation import blade_of, section_of
from bladewright.files.text import read_text
from bladewright.nurbs.basis import Reals
from bladewright.section.unified import UnifiedSection

_CHORDWISE = (1.0 - np.cos(np.pi * (np.arange(60.0) + 0.5) / 60.0)) / 2.0
_SPANWISE = np.linspace(1.0 / 24.0, 23.0 / 24.0, 12)


def is_parablade(text: str) -> bool:
    """Whether a text looks like a ParaBlade configuration."""
    keys = {line.partition("=")[0].strip() for line in text.splitlines() if "=" in line and line[0] not in "#%"}
    return len(keys & {*CHANNEL, *COMMON, *WORDS}) >= 4


def read_parablade(path: str | os.PathLike[str]) -> UnifiedBlade | UnifiedSection:
    """The design of the unified family that comes nearest to the blade of a ParaBlade configuration.

    It is a section where the configuration has two dimensions, else an annular or linear blade. Raises FileError where
    the file is no such configuration, or one of connecting arcs, and DesignError where the unified family has no such
    blade.
    """
    return import_parablade(path).design


def import_parablade(
    path: str | os.PathLike[str], *, chordwise: int | None = None
) -> Imported[UnifiedBlade | UnifiedSection]:
    """The same design, with what was kept and changed, and points of ParaBlade's own blade to measure it with.

    `chordwise` is the number of control points of the thickness laws along the chord; without it 8, or up to 16 where
    that brings the sides closer to ParaBlade's.
    """
    path = Path(path)
    config = parsed(read_text(path), f"'{path}'")
    if config.arcs:
        raise FileError(
            f"'{path}' has PARAMETRIZATION_TYPE = CONNECTING_ARCS, sides that are arcs without camber and thickness: "
            "only CAMBER_THICKNESS is imported; write its points as a cloud with ParaBlade, and fit a design to them"
        )
    name = re.sub(r'[/\\:*?"<>|\s]+', "-", path.stem).strip("-.") or "blade"
    if chordwise is not None and not 2 <= chordwise <= 40:
        raise DesignError(f"{chordwise} control points along the chord were asked for: give 2 to 40")
    try:
        design, changed = _design_of(config, name, chordwise)
    except DesignError as error:
        raise DesignError(f"'{path}': the unified family has no such blade: {error}") from error
    return Imported(
        design=design,
        program="ParaBlade",
        kept=_kept(config),
        changed=(*changed, *config.notes),
        points=_points(config),
    )


def _design_of(config: Config, name: str, chordwise: int | None) -> tuple[UnifiedBlade | UnifiedSection, list[str]]:
    if config.dimensions == 2:
        section, changed = section_of(config, name, chordwise)
        return section, [*changed, f"N_BLADES = {config.blades} says no pitch: a single section is written"]
    blade, changed = blade_of(config, name, chordwise)
    if not config.annular:
        changed.append(
            f"no pitch is in the file: {blade.pitch:.4g} mm is taken, one meridional length; set the true one"
        )
        return blade, changed
    count = most_blades_apart(
        int(blade.blade_count or 1),
        lambda count: exact_unified_blade(blade.changed("blade_count", count)).check_sections(),
    )
    remark = f"N_BLADES = {config.blades} has no effect in ParaBlade, and may be any number there"
    if count != blade.blade_count:
        changed.append(f"{remark}: so many blades intersect, and {count} are taken; set the true number")
        return blade.changed("blade_count", count), changed
    changed.append(f"{remark}: it is taken as it is; set the true one")
    return blade, changed


def _kept(config: Config) -> tuple[str, ...]:
    if config.dimensions == 2:
        return ("the camber line, the mean of ParaBlade's two sections, and the radii of both edges",)
    return (
        'the camber lines in ParaBlade\'s plane (mapping = "paper": its angles are not those of the blade in space)',
        "the numbers of control points along the span",
    )


def _points(config: Config) -> dict[str, Reals]:
    sections = sections_at(config, _SPANWISE)
    rows = side_basis(_CHORDWISE)
    width = 2 if config.dimensions == 2 else 3
    sides = zip(("upper", "lower"), sections.sides, strict=True)
    return {name: sections.points(rows @ controls).reshape(-1, width) for name, controls in sides}
