"""`bladewright sweep`: many designs side by side, every run kept as it ends."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bladewright.cli.build_files import SUFFIXES
from bladewright.cli.directory import removing_partial_files
from bladewright.cli.members import member_designs, resumable, written_designs
from bladewright.cli.options import Call, comma_separated, common
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.errors import StudyError

if TYPE_CHECKING:
    from bladewright.studies.runs import Runs
    from bladewright.studies.sweep import Plan


@click.command(short_help="Many designs: their figures, and pictures of these.")
@click.argument("path", type=click.Path(path_type=Path), metavar="STUDY")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Manifest of the runs.  [STUDY.jsonl]")
@click.option(
    "--table", type=click.Path(path_type=Path), metavar="FILE", help="Runs from a CSV file, in the place of sampling."
)
@click.option(
    "--as",
    "formats",
    callback=comma_separated(tuple(SUFFIXES)),
    help="CAD files of every run, with commas between: step, iges, brep, stl, 3mf.",
)
@click.option(
    "-d", "--directory", type=click.Path(path_type=Path), help="Where CAD files go.  [a folder named like the manifest]"
)
@click.option("--jobs", type=click.IntRange(1, 4096), metavar="N", help="Processes.  [as many as processors]")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask cluster in their place, such as tcp://10.0.0.7:8786.")
@click.option("--member", type=click.IntRange(1), metavar="RUN", help="Write the design of this run of the manifest.")
@click.option("--retry", is_flag=True, help="Repeat the runs that have failed.")
@click.option("--csv", "table_file", type=click.Path(path_type=Path), metavar="FILE", help="Write the runs as CSV.")
@click.option(
    "--parallel", type=click.Path(path_type=Path), metavar="FILE", help="Picture of all runs in parallel coordinates."
)
@click.option("--scatter", type=click.Path(path_type=Path), metavar="FILE", help="Picture of a scatter matrix.")
@click.option("--effects", type=click.Path(path_type=Path), metavar="FILE", help="Picture of the main effects.")
@common
@click.pass_obj
def sweep(
    call: Call,
    /,
    path: Path,
    output: Path | None,
    table: Path | None,
    formats: tuple[Any, ...] | None,
    directory: Path | None,
    jobs: int | None,
    scheduler: str | None,
    member: int | None,
    retry: bool,
    table_file: Path | None,
    parallel: Path | None,
    scatter: Path | None,
    effects: Path | None,
) -> Outcome:
    """Build and measure the designs of STUDY, a file that says what is varied, how, and what is looked at.

    Every run is a line of the manifest as soon as it has ended: its parameters, its figures, and whether it was built,
    verified, refused or has failed, and why. A sweep that was stopped goes on where the same command is given again.
    STUDY may be such a manifest, which is then repeated. --member 12 --as step writes the design of run 12 as
    DESIGN-0012.toml, and as verified CAD files.

    The exit status is 1 where runs have failed, or none was built; designs that are refused do not fail.
    """
    from bladewright.studies.study import read_study
    from bladewright.studies.sweep import planned

    if jobs is not None and scheduler is not None:
        raise click.UsageError("--jobs are processes of this machine, --scheduler is a cluster: leave one out")
    pictures = {"parallel": parallel, "scatter": scatter, "effects": effects}
    manifest = output or _manifest_of(path, is_read=member is not None)
    study = read_study(path)
    options = study.sweep
    if table is not None:
        options = replace(options, table=str(table.absolute()))
    if formats is not None:
        options = replace(options, files=formats)
    plan = planned(replace(study, sweep=options), directory=directory or manifest.with_suffix(""))
    if member is not None:
        designs = member_designs(plan.experiment.designs, plan.experiment.variables, manifest, member)
        return written_designs(designs, f"{member:04d}", directory or Path(), formats, call)
    with _writing(table_file, *pictures.values()):
        with resumable(manifest):
            runs = _carried_out(plan, manifest, call, jobs=jobs, scheduler=scheduler, retry=retry)
        if table_file is not None:
            runs.to_csv(table_file)
        drawn = _drawn(runs, pictures)
    written = [manifest, *([table_file] if table_file else []), *drawn]
    return Outcome(
        data={**runs.to_dict(), "manifest": str(manifest), "written": [str(each) for each in written]},
        text="\n".join([str(runs), *(f"wrote {each}" for each in written)]),
        failures=_failures(runs),
    )


def _manifest_of(path: Path, *, is_read: bool) -> Path:
    """The manifest of a study that is not told where to keep its runs."""
    if path.suffix == ".jsonl" and is_read:
        return path
    if path.suffix == ".jsonl":
        raise click.UsageError(f"'{path}' is a manifest, which is repeated into another one: name it with -o")
    return Path(f"{path.stem}.jsonl")


def _carried_out(plan: "Plan", manifest: Path, call: Call, **options: Any) -> "Runs":
    with progress(plan.total, call, time_left=True) as bar:
        bar.set_description_str(plan.study.name)

        def begin(done: int) -> None:
            bar.initial = bar.n = done

        return plan.carried_out(manifest, progress=lambda _: bar.update(1), begun=begin, **options)


def _drawn(runs: "Runs", pictures: dict[str, Path | None]) -> list[Path]:
    """Draw what is asked for."""
    wanted = {name: path for name, path in pictures.items() if path is not None}
    if not wanted:
        return []
    if not runs.figures:
        raise StudyError("there is nothing to draw: no run has figures; the manifest says why")
    from bladewright.views.runs import DRAWINGS, draw_runs

    for name, path in wanted.items():
        draw_runs(DRAWINGS[name], runs, path)
    return list(wanted.values())


def _failures(runs: "Runs") -> tuple[str, ...]:
    """A paragraph for what has failed."""
    failed = [run for run, verdict in zip(runs.numbers, runs.verdicts, strict=True) if verdict == "failed"]
    if failed:
        words = f"{len(failed)} of {len(runs)} runs have failed, the first of them run {failed[0]}"
        return (f"{runs.name}: {words}: {runs.reasons[failed[0]]}",)
    if not runs.good.any():
        first = next(iter(runs.reasons.values()), "there were none")
        return (f"{runs.name}: no design of {len(runs)} could be built: {first}",)
    return ()


@contextmanager
def _writing(table: Path | None, *pictures: Path | None) -> Iterator[None]:
    """A context in which the files that are wanted can be written; FileError, before any work, where not."""
    wanted = [path for path in pictures if path is not None]
    with ExitStack() as stack:
        for path in [*([table] if table else []), *wanted]:
            stack.enter_context(removing_partial_files(path.parent, [path.name]))
        if wanted:
            from bladewright.views.pages import checked_path

            for path in wanted:
                checked_path(path)
        yield
