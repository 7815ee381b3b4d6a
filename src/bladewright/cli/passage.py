"""The passage that `bladewright show` describes: around a blade, or around a section where the design is 2D."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from bladewright.cli.blueprint import named
from bladewright.cli.domain import passage_from
from bladewright.cli.outcome import jsonable
from bladewright.cli.summary import data_of
from bladewright.errors import DesignError

LIMITS = {"ring_filled": 1e-6, "walls": 1e-7}
"""of the ring's volume by which passages and blades miss it, and of the chord by which walls miss theirs"""


def flow_domain(design: Any, path: Path, reach: Mapping[str, Any]) -> Any:
    """The passage of a design, 2D where the design is.

    Raises DesignError, naming the file at `path`, where the shape is impossible.
    """
    from bladewright.section.unified import UnifiedSection

    if not isinstance(design, UnifiedSection):
        return passage_from(design, path, **reach)
    from bladewright.domain.section import section_passage
    from bladewright.section.checks import UNITS

    if reach.get("split"):
        raise click.UsageError("--split cuts the faces of a passage: the curves around a 2D section have no creases")
    if design.pitch is None:
        raise DesignError(f"{path}: pitch is missing: a passage lies between neighbours; set pitch in the design")
    asked = {name: value for name, value in reach.items() if name != "split" and value is not None}
    with named(path):
        return section_passage(design.build(), design.pitch * UNITS[design.length_unit], **asked)


def passage_data(design: Any, made: Any) -> dict[str, Any]:
    """Figures as `data_of` gives them, and those of a passage alone: ring, extents, folds and what they are held to."""
    import numpy as np

    if hasattr(made, "section"):
        area = {"area": made.area, "pitch": np.ptp(np.real(made.curves["inlet"].control_points[:, 1]))}
        return {**data_of(design, made), "name": f"{design.name}-passage", "properties": jsonable(area)}
    reached = {"ring_filled": abs(made.ring_error), "walls": made.wall_error}
    folds = {name: dict(zip(("share", "u", "v"), fold, strict=True)) for name, fold in made.folds.items()}
    own = {
        "name": made.name,
        "ring_m3": np.real(made.ring),
        "upstream": made.knots.upstream,
        "downstream": made.knots.downstream,
        "meridional_length_m": made.knots.length,
        "least_jacobian": folds,
        "promises": {**reached, "limits": LIMITS, "kept": all(reached[each] <= LIMITS[each] for each in LIMITS)},
    }
    return {**data_of(design, made), **{key: jsonable(value) for key, value in own.items()}}


def passage_rows(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names and values of what a passage alone has, to read."""
    if "ring_m3" not in data:
        return []
    length = data["meridional_length_m"] * 1e3
    rows = [("ring", f"{data['ring_m3'] * 1e9:.6g} mm3")]
    rows += [(name, f"{data[name]:.4g} meridional lengths of {length:.6g} mm") for name in ("upstream", "downstream")]
    name, fold = min(data["least_jacobian"].items(), key=lambda each: each[1]["share"])
    said = f"{fold['share']:.2g} of its median, on {name} at u = {fold['u']:.4g}, v = {fold['v']:.4g}"
    return [*rows, ("least Jacobian", said)]
