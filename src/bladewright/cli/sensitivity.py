"""`bladewright sensitivity`: derivatives of what a design builds, their check, and the chain to a flow solver."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.load_design import built_from, load_design
from bladewright.cli.options import Call, common, design_argument, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.cli.stations import parse_stations
from bladewright.cli.summary import COMPONENTS
from bladewright.designs import unit_at

if TYPE_CHECKING:
    from bladewright.derivatives.quantities import NamedQuantity
    from bladewright.derivatives.step_study import StepStudy

PASSAGE = "passage-volume"
"""The quantity `--of passage-volume`: the volume of the passage around a blade."""
OF_WHEEL = ("volume", "mass", "moment-of-inertia")
"""Quantities of a blade that a wheel has as well, as `--of wheel-mass`."""


def _parse_grid(_: click.Context, __: click.Parameter, text: str) -> tuple[int, int]:
    """Read numbers of points such as 81x21."""
    along, _sign, across = text.lower().partition("x")
    if not (along.strip().isdigit() and across.strip().isdigit()):
        raise click.BadParameter(f"'{text}' is no number of points along and across: write it like 81x21")
    return int(along), int(across)


@click.command(short_help="Derivatives by every parameter, and their check.")
@design_argument
@click.option(
    "--of",
    "of",
    metavar="QUANTITY",
    help="volume, area, centroid, inertia, chord, throat, mass, moment-of-inertia, passage-volume, wheel-volume, "
    "wheel-mass, wheel-moment-of-inertia, or surface: the control points of the sides; "
    "of a section: area, centroid, chord, perimeter, camber-length, surface; or a column of the station table, such as "
    "turning, stagger, solidity, wrap, sweep, lean, maximum-thickness.  [volume; area of a section; surface with "
    "--check]",
)
@click.option(
    "--stations",
    callback=parse_stations,
    default="0.5",
    show_default=True,
    metavar="SPANS",
    help="Where a column of the station table is taken, such as 0,0.5,1.",
)
@click.option(
    "--free", multiple=True, metavar="PATTERN", help="Only these parameters, such as 'stagger[*]'. Repeatable."
)
@click.option("--check", is_flag=True, help="Compare with central differences over a study of steps.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Picture of the check: .png, .svg or .pdf.")
@click.option(
    "--write-points", type=click.Path(path_type=Path), metavar="FILE", help="Points of both sides for SU2_DEF."
)
@click.option(
    "--points", default="81x21", show_default=True, callback=_parse_grid, help="How many, along and across a side."
)
@click.option(
    "--from",
    "sensitivity_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="SU2's surface_sens.csv or .vtu: derivatives of its objective, with --points-file.",
)
@click.option("--points-file", type=click.Path(path_type=Path), metavar="FILE", help="What --write-points wrote.")
@set_option
@common
@click.pass_obj
def sensitivity(
    call: Call,
    path: Path,
    of: str | None,
    stations: tuple[float, ...],
    free: tuple[str, ...],
    check: bool,
    output: Path | None,
    write_points: Path | None,
    points: tuple[int, int],
    sensitivity_file: Path | None,
    points_file: Path | None,
    changes: dict[str, Any],
) -> Outcome:
    """Print the derivatives of a quantity of what DESIGN builds by its parameters, exact to rounding.

    --check compares each with central differences at held knots; the exit status is 1 where one differs, is not finite,
    or a parameter has no effect on the surface. --write-points and --from chain a design to the flow solver SU2: its
    adjoint's sensitivity at the points becomes the gradient of its objective by the parameters.
    """
    _one_task(check=check, output=output, write_points=write_points, of=of, given=(sensitivity_file, points_file))
    design = load_design(path, changes)
    built = built_from(design, path)
    if write_points is not None:
        return _write_points(built, write_points, points)
    if sensitivity_file is not None and points_file is not None:
        return _pull_back(design, built, free, sensitivity_file, points_file)
    if check:
        return _check(call, design, built, _quantity(built, of or "surface", stations), free, output)
    quantity = _quantity(built, of or ("volume" if built.dimension == 3 else "area"), stations)
    return _derivatives(call, design, built, quantity, free, stations)


def _one_task(
    *,
    check: bool,
    output: Path | None,
    write_points: Path | None,
    of: str | None,
    given: tuple[Path | None, Path | None],
) -> None:
    """Raise a usage error where options do not go together."""
    if output is not None and not check:
        raise click.UsageError("-o draws the check: ask for it with --check")
    if (given[0] is None) != (given[1] is None):
        raise click.UsageError("--from and --points-file belong together: a sensitivity, and the points that it is of")
    tasks = {"--check": check, "--write-points": write_points is not None, "--from": given[0] is not None}
    chosen_tasks = [name for name, wanted in tasks.items() if wanted]
    if len(chosen_tasks) > 1:
        raise click.UsageError(f"{' and '.join(chosen_tasks)} are different tasks: call the program once for each")
    if of is not None and chosen_tasks and chosen_tasks != ["--check"]:
        raise click.UsageError(f"--of chooses a quantity, which {chosen_tasks[0]} does not take")


def _derivatives(
    call: Call, design: Any, built: Any, quantity: "NamedQuantity", free: Sequence[str], stations: Sequence[float]
) -> Outcome:
    """Table of the derivatives of a named quantity."""
    import numpy as np

    from bladewright.derivatives.patterns import chosen
    from bladewright.derivatives.sensitivity import sensitivity
    from bladewright.derivatives.step_study import size_of

    paths = chosen(design, list(free) or None)
    with progress(1, call) as bar:
        bar.set_description_str(quantity.name)
        rates = _rates(design, built, quantity, paths) or sensitivity(
            design, quantity.of, free=paths, knots=built.knots
        )
        bar.update(1)
    if quantity.points:
        rates = {path: np.asarray(size_of(rate, quantity)) for path, rate in rates.items()}
    value = None if quantity.points else np.real(np.asarray(quantity.of(built)))
    unit, table_unit, factor = _units(quantity, design)
    units = {path: unit + _per_parameter(design, path) for path in paths}
    data = {
        "name": design.name,
        "quantity": quantity.name,
        "unit": unit,
        "value": value,
        "derivatives": rates,
        "units": units,
    }
    head = f"{data['name']}: {quantity.name}"
    head += ", root mean square over the control points" if quantity.points else ""
    head += f" {_named_figures(quantity.name, value * factor, table_unit, stations)}" if value is not None else ""
    rows = [(path, _figures(rate, factor), table_unit + _per_parameter(design, path)) for path, rate in rates.items()]
    return Outcome(data=data, text=_table(head, rows))


def _check(
    call: Call, design: Any, built: Any, quantity: "NamedQuantity", free: Sequence[str], output: Path | None
) -> Outcome:
    """Table of each derivative checked against central differences; a picture as well where `output` names one."""
    from bladewright.derivatives.step_study import LIMIT, step_studies
    from bladewright.derivatives.variables import variables

    if output is not None:
        from bladewright.views.pages import checked_path

        checked_path(output)
    space = variables(design, free=list(free) or None, knots=built.knots)
    studies: list[StepStudy] = []
    with progress(len(space.paths), call) as bar:
        for study in step_studies(design, built, quantity, space):
            bar.set_description_str(study.path)
            studies.append(study)
            bar.update(1)
    name = design.name
    failures = tuple(f"{name}: {study.failure}" for study in studies if study.failure)
    data = {
        "name": name,
        "quantity": quantity.name,
        "limit": LIMIT,
        "passed": not failures,
        "checks": [_record(study) for study in studies],
    }
    head = f"{name}: {quantity.name} by {len(studies)} parameters; relative error of the closest central difference, "
    head += "and of the derivative by other complex steps"
    rows = [(study.path, *_verdict(study)) for study in studies]
    text = _table(head, rows)
    verdict = f"{len(failures)} of {len(studies)} FAILED" if failures else "all passed"
    text += f"\nchecked: the closest difference within {LIMIT:g} of each derivative: {verdict}"
    if output is not None:
        from bladewright.views.step_study import draw_step_studies

        draw_step_studies(
            studies, output, title=f"{name}: the {quantity.name} by {len(studies)} parameters", limit=LIMIT
        )
        data["picture"] = str(output)
        text += f"\nwrote {output}"
    return Outcome(data=data, text=text, failures=failures)


def _write_points(built: Any, path: Path, points: tuple[int, int]) -> Outcome:
    """Write points of both sides for SU2_DEF, and their surface parameters beside them."""
    from bladewright.derivatives.surface_points import surface_points
    from bladewright.files.su2 import write_surface_points

    surface = surface_points(built, along=points[0], across=points[1])
    places = write_surface_points(surface, path)
    data = {"points": len(surface.ids), "file": str(path), "places": str(places)}
    return Outcome(data=data, text=f"wrote {len(surface.ids)} points to {path}, and where they lie to {places}")


def _pull_back(design: Any, built: Any, free: Sequence[str], sensitivity: Path, points_file: Path) -> Outcome:
    """Table of the gradient of a solver's objective, from its sensitivity at the points of a file."""
    from bladewright.derivatives.net_jacobian import pullback
    from bladewright.files.su2 import check_same_design, read_surface_points, read_surface_sensitivity

    points = read_surface_points(points_file)
    check_same_design(points_file, points, points.on(built))
    bars = points.bars(read_surface_sensitivity(sensitivity, points))
    rates = pullback(design, bars, free=list(free) or None, knots=built.knots)
    units = {path: f"1{_per_parameter(design, path)}" for path in rates}
    name = design.name
    data = {"name": name, "quantity": "objective", "points": len(points.ids), "derivatives": rates, "units": units}
    rows = [(path, f"{rate:.6g}", units[path]) for path, rate in rates.items()]
    return Outcome(data=data, text=_table(f"{name}: objective of {sensitivity} at {len(points.ids)} points", rows))


def _quantity(built: Any, name: str, stations: Sequence[float]) -> "NamedQuantity":
    """The quantity of this name; a blade has those of its passage and its wheel besides its own."""
    from bladewright.derivatives.quantities import BLADE, NamedQuantity, named_quantity

    more: dict[str, NamedQuantity] = {}
    if built.dimension == 3:
        more[PASSAGE] = NamedQuantity(name=PASSAGE, of=_PassageVolume(), power=3)
        more |= {
            f"wheel-{each}": replace(BLADE[each], name=f"wheel-{each}", of=_OfWheel(BLADE[each].of))
            for each in OF_WHEEL
        }
    return named_quantity(built, name, more, stations)


class _PassageVolume:
    """The volume of a blade's passage, at the knots and extents of the passage of the first blade."""

    def __init__(self) -> None:
        self.knots: Any = None

    def __call__(self, blade: Any) -> Any:
        from bladewright.domain.build import passage

        passage_around = passage(blade, knots=self.knots)
        self.knots = passage_around.knots
        return passage_around.properties.volume


class _OfWheel:
    """A quantity of the wheel of a blade, at the knots of the wheel of the first blade."""

    def __init__(self, of: Callable[[Any], Any]) -> None:
        self.of, self.knots = of, None

    def __call__(self, blade: Any) -> Any:
        import bladewright as bw

        make: Any = bw
        wheel = make.wheel(blade, knots=self.knots)
        self.knots = wheel.knots
        return self.of(wheel)


def _rates(design: Any, built: Any, quantity: "NamedQuantity", paths: Sequence[str]) -> dict[str, Any] | None:
    """The derivatives of a passage's volume from its control nets, or None where another way is needed.

    This is many times faster than rebuilding the passage for every parameter.
    """
    if quantity.name != PASSAGE:
        return None
    from bladewright.blade.native.properties import middle_of
    from bladewright.derivatives.enclosed_volume import enclosed_volume_rates
    from bladewright.derivatives.net_jacobian import net_jacobian
    from bladewright.domain.build import passage
    from bladewright.errors import DerivativeError

    body = passage(built)
    jacobian = net_jacobian(design, free=list(paths), knots=built.knots, of=passage)
    volume, revolved = float(body.properties.volume), built.exact.mapping.revolved
    try:
        rates = enclosed_volume_rates(jacobian, body.orientations, volume, middle_of(built.surfaces), revolved=revolved)
    except DerivativeError:
        return None
    return dict(rates)


def _record(study: "StepStudy") -> dict[str, Any]:
    return {
        "path": study.path,
        "passed": not study.failure,
        "derivative_rms": study.size,
        "closest": study.best,
        "scale": study.scale,
        "steps": study.steps,
        "errors": study.errors,
        "complex_steps": study.imaginary,
        "complex_errors": study.floor,
        "note": study.failure or study.note,
    }


def _verdict(study: "StepStudy") -> tuple[str, str]:
    """The closest difference and the error of the complex step, and whether the check failed."""
    import numpy as np

    if not len(study.errors):
        return "", (study.failure or study.note).removeprefix(study.path).lstrip(": ")
    return f"{study.best:.1e}  {np.min(study.floor, initial=np.inf):.1e}", "FAILED" if study.failure else ""


def _units(quantity: "NamedQuantity", design: Any) -> tuple[str, str, float]:
    """The SI unit of the JSON figures, and the unit of the table, the design's or degrees, with its factor."""
    import math

    from bladewright.section.checks import UNITS

    if quantity.angle:
        return "rad", "deg", math.degrees(1.0)
    if quantity.unit:
        return quantity.unit, quantity.unit, 1.0
    power, unit = quantity.power, design.length_unit
    if power == 0:
        return "1", "1", 1.0
    raised = "" if power == 1 else str(power)
    return f"m{raised}", f"{unit}{raised}", UNITS[unit] ** -power


def _per_parameter(design: Any, path: str) -> str:
    """What is appended to the unit of a quantity to make the unit of its derivative."""
    unit = unit_at(design, path)
    alone = f"({unit})" if "/" in str(unit) else unit
    return {"length": f"/{design.length_unit}", "-": ""}.get(str(unit), f"/{alone}")


def _named_figures(name: str, value: Any, unit: str, stations: Sequence[float]) -> str:
    """The entries of a quantity with unit, each named by its component or its station where there are several."""
    import numpy as np

    figures, shown = [f"{entry:.6g}" for entry in np.ravel(value)], "" if unit == "1" else f" {unit}"
    components = COMPONENTS.get(name, ())
    if components:
        return ", ".join(f"{part} {figure}" for part, figure in zip(components, figures, strict=False)) + shown
    if len(figures) == len(stations) > 1:
        return ", ".join(f"{figure}{shown} at span {v:g}" for figure, v in zip(figures, stations, strict=True))
    return " ".join(figures) + shown


def _figures(value: Any, factor: float) -> str:
    import numpy as np

    return " ".join(f"{entry * factor:.6g}" for entry in np.ravel(value))


def _table(head: str, rows: Sequence[Sequence[str]]) -> str:
    widths = [max((len(row[place]) for row in rows), default=0) for place in range(2)]
    lines = [f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]}".rstrip() for row in rows]
    return "\n".join([head, *lines])
