"""`bladewright optimise`: the best design of a study, or its Pareto set, and the files of each member."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bladewright.cli.build_files import SUFFIXES
from bladewright.cli.members import member_designs, resumable, written_designs
from bladewright.cli.options import Call, comma_separated, common
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress, status_line

if TYPE_CHECKING:
    from bladewright.studies.optimise import Search
    from bladewright.studies.optimum import Optimum
    from bladewright.studies.pareto import ParetoSet


@click.command(short_help="The best design of a study, or its Pareto set.")
@click.argument("path", type=click.Path(path_type=Path), metavar="STUDY")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Manifest of the runs.  [STUDY.jsonl]")
@click.option("--member", type=click.IntRange(1), metavar="RUN", help="Write the design of this run of the manifest.")
@click.option(
    "--as",
    "formats",
    callback=comma_separated(tuple(SUFFIXES)),
    help="CAD files of the optimum or the member, with commas between: step, iges, brep, stl, 3mf.",
)
@click.option(
    "-d", "--directory", type=click.Path(path_type=Path), default=".", help="Where designs and their CAD files go."
)
@click.option("--jobs", type=click.IntRange(1, 4096), metavar="N", help="Processes.  [as many as processors]")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask cluster in their place, such as tcp://10.0.0.7:8786.")
@click.option("--csv", "table_file", type=click.Path(path_type=Path), metavar="FILE", help="Write the members as CSV.")
@click.option(
    "--picture", type=click.Path(path_type=Path), metavar="FILE", help="Picture of the front, or of how it was reached."
)
@click.option(
    "--parallel",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Picture of the members in parallel coordinates.",
)
@common
@click.pass_obj
def optimise(
    call: Call,
    /,
    path: Path,
    output: Path | None,
    member: int | None,
    formats: tuple[str, ...] | None,
    directory: Path,
    jobs: int | None,
    scheduler: str | None,
    table_file: Path | None,
    picture: Path | None,
    parallel: Path | None,
) -> Outcome:
    """Search the best designs of STUDY, a file that says what is varied, what is to be small or large, and the limits.

    One objective gives the optimum, DESIGN-optimum.toml: by exact derivatives, and checked by the conditions of Karush,
    Kuhn and Tucker. Several give a Pareto set. Each iteration or run is a line of the manifest as soon as it has ended,
    and a search that was stopped goes on where the same command is given again. --member 12 --as step writes run 12 of
    that manifest as DESIGN-0012.toml and as verified CAD files.

    The exit status is 1 where a search with derivatives has not ended at an optimum, or no design keeps all
    constraints.
    """
    from bladewright.studies.optimise import Search
    from bladewright.studies.study import read_study

    if jobs is not None and scheduler is not None:
        raise click.UsageError("--jobs are processes of this machine, --scheduler is a cluster: leave one out")
    _check_pictures(picture, parallel)
    study, manifest = read_study(path), output or Path(f"{path.stem}.jsonl")
    if member is not None:
        if picture or parallel or table_file:
            raise click.UsageError("--member writes one design: leave the table and the pictures to the search itself")
        designs = member_designs(study.designs, study.variables, manifest, member)
        return written_designs(designs, f"{member:04d}", directory, formats, call)
    search = Search(study)
    if formats and not search.single:
        raise click.UsageError("--as writes one design: name it with --member, by its run in the Pareto set")
    with resumable(manifest):
        if search.single:
            with status_line(call) as show:
                found = search.optimum(
                    manifest, progress=lambda figures: show(f"{study.name}: {_line(search, figures)}")
                )
            return _optimum(found, call, manifest, directory, formats, picture)
        with progress(search.total, call, time_left=True) as bar:
            bar.set_description_str(study.name)
            front = search.pareto_set(manifest, jobs=jobs, scheduler=scheduler, progress=lambda _: bar.update(1))
    return _front(front, path, manifest, table_file, picture, parallel)


def _optimum(
    found: "Optimum",
    call: Call,
    manifest: Path,
    directory: Path,
    formats: tuple[str, ...] | None,
    picture: Path | None,
) -> Outcome:
    """The optimum's design, files and picture."""
    files = written_designs(found.designs, "optimum", directory, formats, call)
    written = [str(manifest), *files.data["written"]]
    if picture is not None:
        from bladewright.views.optimum import draw_optimum

        draw_optimum(found, picture)
        written.append(str(picture))
    texts = [str(found), *([files.text] if formats else []), *(f"wrote {each}" for each in written)]
    return Outcome(
        data={**found.to_dict(), "cad": files.data["cad"], "manifest": str(manifest), "written": written},
        text="\n".join(texts),
        failures=(*(f"{found.name}: {each}" for each in found.failures), *files.failures),
    )


def _front(
    found: "ParetoSet", study: Path, manifest: Path, table: Path | None, picture: Path | None, parallel: Path | None
) -> Outcome:
    """The Pareto set, its table and pictures."""
    written = [manifest]
    failures = [f"{found.name}: {each}" for each in found.failures]
    if not found.members:
        failures.append(f"{found.name}: no design of {len(found.runs)} keeps all constraints: {_nearest(found)}")
    if table is not None:
        found.to_csv(table)
        written.append(table)
    if found.members:
        written += _drawn(found, picture, parallel)
    hint = f"bladewright optimise {study} --member {found.members[0]} --as step" if found.members else ""
    texts = [str(found), *([f"a member as CAD files: {hint}"] if hint else []), *(f"wrote {each}" for each in written)]
    return Outcome(
        data={**found.to_dict(), "manifest": str(manifest), "written": [str(each) for each in written]},
        text="\n".join(texts),
        failures=tuple(failures),
    )


def _drawn(found: "ParetoSet", picture: Path | None, parallel: Path | None) -> list[Path]:
    if picture is not None:
        from bladewright.views.pareto import draw_fronts

        draw_fronts([found], picture)
    if parallel is not None:
        from bladewright.views.runs import draw_runs, parallel_coordinates

        draw_runs(parallel_coordinates, found.best, parallel)
    return [path for path in (picture, parallel) if path is not None]


def _nearest(found: "ParetoSet") -> str:
    """Which constraint the design violates most that comes nearest to keeping all."""
    near = found.nearest
    if near is None:
        return "none could be built and measured; the manifest says why"
    number, limit, excess = near
    return f"run {number} comes nearest and misses the limit of {limit.figure} by {100.0 * excess:.3g} %; widen it"


def _line(search: "Search", figures: Mapping[str, float]) -> str:
    aim = search.goals.aims[0].figure
    return f"{aim} {figures[aim]:.6g}"


def _check_pictures(*paths: Path | None) -> None:
    """FileError, before any work, where a picture cannot be written."""
    from bladewright.views.pages import checked_path

    for path in paths:
        if path is not None:
            checked_path(path)
