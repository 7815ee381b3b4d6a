"""What `bladewright sensitivity` finds, for people and for programs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bladewright.cli.options import Call
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.designs import Design, unit_at

if TYPE_CHECKING:
    from bladewright.derivatives.quantities import NamedQuantity
    from bladewright.derivatives.step_study import StepStudy

PASSAGE = "passage-volume"


def derivatives_of(call: Call, design: Design, built: Any, of: str | None, free: Sequence[str]) -> Outcome:
    """The derivatives of a named quantity: a table."""
    from bladewright.derivatives.patterns import chosen
    from bladewright.derivatives.sensitivity import sensitivity
    from bladewright.derivatives.step_study import size_of

    quantity = _quantity(built, of or ("volume" if hasattr(built, "surfaces") else "area"))
    paths = chosen(design, list(free) or None)
    with progress(1, call) as bar:
        bar.set_description_str(quantity.name)
        rates = _rates(design, built, quantity, paths) or sensitivity(
            design, quantity.of, free=paths, knots=getattr(built, "knots", None)
        )
        bar.update(1)
    if quantity.points:
        rates = {path: np.asarray(size_of(rate, quantity)) for path, rate in rates.items()}
    value = None if quantity.points else np.real(np.asarray(quantity.of(built)))
    unit, shown = _units(quantity.power)
    units = {path: unit + _by(design, path) for path in paths}
    data = {
        "name": getattr(design, "name", ""),
        "quantity": quantity.name,
        "unit": unit,
        "value": value,
        "derivatives": rates,
        "units": units,
    }
    head = f"{data['name']}: {quantity.name}"
    head += ", root mean square over the control points" if quantity.points else ""
    head += f" {_figures(value, shown[1])} {shown[0]}" if value is not None else ""
    rows = [(path, _figures(rate, shown[1]), shown[0] + _by(design, path)) for path, rate in rates.items()]
    return Outcome(data=data, text=_table(head, rows))


def checked(call: Call, design: Design, built: Any, of: str, free: Sequence[str], output: Path | None) -> Outcome:
    """The check of each derivative against central differences: a table, a picture where one is named."""
    from bladewright.derivatives.step_study import LIMIT, step_studies
    from bladewright.derivatives.variables import variables

    if output is not None:
        from bladewright.views.pages import checked_path

        checked_path(output)
    quantity = _quantity(built, of)
    space = variables(design, free=list(free) or None, knots=getattr(built, "knots", None))
    found: list[StepStudy] = []
    with progress(len(space.paths), call) as bar:
        for sweep in step_studies(design, built, quantity, space):
            bar.set_description_str(sweep.path)
            found.append(sweep)
            bar.update(1)
    name = str(getattr(design, "name", ""))
    failures = tuple(f"{name}: {sweep.failure}" for sweep in found if sweep.failure)
    data = {
        "name": name,
        "quantity": quantity.name,
        "limit": LIMIT,
        "passed": not failures,
        "checks": [_record(sweep) for sweep in found],
    }
    head = f"{name}: {quantity.name} by {len(found)} parameters; closest difference, and complex step"
    rows = [(sweep.path, *_verdict(sweep)) for sweep in found]
    text = _table(head, rows)
    text += f"\n{len(failures)} of {len(found)} FAILED" if failures else f"\nall within {LIMIT:g}"
    if output is not None:
        from bladewright.views.step_study import draw_step_studies

        draw_step_studies(found, output, title=f"{name}: the {quantity.name} by {len(found)} parameters", limit=LIMIT)
        data["picture"] = str(output)
        text += f"\nwrote {output}"
    return Outcome(data=data, text=text, failures=failures)


def written_points(built: Any, path: Path, points: tuple[int, int]) -> Outcome:
    """Points of both sides in files."""
    from bladewright.derivatives.surface_points import surface_points
    from bladewright.files.su2 import write_surface_points

    found = surface_points(built, along=points[0], across=points[1])
    beside = write_surface_points(found, path)
    data = {"points": len(found.ids), "file": str(path), "places": str(beside)}
    return Outcome(data=data, text=f"wrote {len(found.ids)} points to {path}, and where they lie to {beside}")


def pulled_back(design: Design, built: Any, free: Sequence[str], sensitivity: Path, points_file: Path) -> Outcome:
    """The gradient of a solver's objective, from its sensitivity at the points of a file."""
    from bladewright.derivatives.net_jacobian import pullback
    from bladewright.files.su2 import check_same_design, read_surface_points, read_surface_sensitivity

    points = read_surface_points(points_file)
    check_same_design(points_file, points, points.on(built))
    bars = points.bars(read_surface_sensitivity(sensitivity, points))
    rates = pullback(design, bars, free=list(free) or None, knots=getattr(built, "knots", None))
    units = {path: f"1{_by(design, path)}" for path in rates}
    name = getattr(design, "name", "")
    data = {"name": name, "quantity": "objective", "points": len(points.ids), "derivatives": rates, "units": units}
    rows = [(path, f"{rate:.6g}", units[path]) for path, rate in rates.items()]
    return Outcome(data=data, text=_table(f"{name}: objective of {sensitivity} at {len(points.ids)} points", rows))


def _quantity(built: Any, name: str) -> "NamedQuantity":
    from bladewright.derivatives.quantities import NamedQuantity, named_quantity

    more: dict[str, NamedQuantity] = {}
    if hasattr(built, "surfaces"):
        more[PASSAGE] = NamedQuantity(name=PASSAGE, of=_PassageVolume(), power=3)
    return named_quantity(built, name, more)


class _PassageVolume:
    """The volume of a blade's passage, at the knots and extents of the first blade's."""

    def __init__(self) -> None:
        self.knots: Any = None

    def __call__(self, blade: Any) -> Any:
        from bladewright.domain.build import passage

        found = passage(blade, knots=self.knots)
        self.knots = found.knots
        return found.properties.volume


def _rates(design: Any, built: Any, quantity: "NamedQuantity", paths: Sequence[str]) -> dict[str, Any] | None:
    """The derivatives of a passage's volume from its nets, where they can be had so, which is many times faster."""
    if quantity.name != PASSAGE:
        return None
    from bladewright.blade.native.properties import middle_of
    from bladewright.derivatives.enclosed_volume import enclosed_volume_rates
    from bladewright.derivatives.net_jacobian import net_jacobian
    from bladewright.domain.build import passage
    from bladewright.errors import DerivativeError

    body = passage(built)
    found = net_jacobian(design, free=list(paths), knots=built.knots, of=passage)
    volume, revolved = float(body.properties.volume), built.exact.mapping.revolved
    try:
        rates = enclosed_volume_rates(found, body.orientations, volume, middle_of(built.surfaces), revolved=revolved)
    except DerivativeError:
        return None
    return dict(rates)


def _record(sweep: "StepStudy") -> dict[str, Any]:
    return {
        "path": sweep.path,
        "passed": not sweep.failure,
        "derivative_rms": sweep.size,
        "closest": sweep.best,
        "scale": sweep.scale,
        "steps": sweep.steps,
        "errors": sweep.errors,
        "complex_steps": sweep.imaginary,
        "complex_errors": sweep.floor,
        "note": sweep.failure or sweep.note,
    }


def _verdict(sweep: "StepStudy") -> tuple[str, str]:
    if not len(sweep.errors):
        return sweep.failure or sweep.note, ""
    return f"{sweep.best:.1e}  {np.min(sweep.floor):.1e}", "FAILED" if sweep.failure else ""


def _units(power: int) -> tuple[str, tuple[str, float]]:
    """The unit in a program's figures, and a person's unit with its factor."""
    raised = "" if power == 1 else str(power)
    return f"m{raised}", (f"mm{raised}", 1e3**power)


def _by(design: Any, path: str) -> str:
    """What follows a unit where it is per unit of a parameter."""
    unit = unit_at(design, path)
    return {"length": f"/{getattr(design, 'length_unit', 'm')}", "-": ""}.get(str(unit), f"/{unit}")


def _figures(value: Any, factor: float) -> str:
    return " ".join(f"{entry * factor:.6g}" for entry in np.ravel(value))


def _table(head: str, rows: Sequence[Sequence[str]]) -> str:
    widths = [max((len(row[place]) for row in rows), default=0) for place in range(2)]
    lines = [f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]}".rstrip() for row in rows]
    return "\n".join([head, *lines])
