"""What the commands of studies share: how they go on, and single designs with their CAD files."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bladewright.cli.build_files import BuildOptions, build_files
from bladewright.cli.options import Call
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress
from bladewright.errors import StudyError

if TYPE_CHECKING:
    from bladewright.designs import Design
    from bladewright.studies.variables import Variable


@contextmanager
def resumable(manifest: Path) -> Iterator[None]:
    """A context whose interrupts say how a study goes on."""
    try:
        yield
    except KeyboardInterrupt as error:
        raise KeyboardInterrupt(f"what has ended is in '{manifest}', and the same command goes on") from error


def member_designs(
    designs: "Mapping[str, Design]", variables: "Sequence[Variable]", manifest: Path, member: int
) -> "Mapping[str, Design]":
    """The designs of a study as a run of its manifest has them, by name; StudyError where there is no such run."""
    from bladewright.studies.manifest import read_manifest
    from bladewright.studies.variables import changed_designs

    for record in read_manifest(manifest)[1]:
        if record.run == member:
            if record.verdict == "refused":
                raise StudyError(f"run {member} of '{manifest}' was refused: {record.reason}")
            return changed_designs(designs, variables, record.parameters)
    raise StudyError(f"there is no run {member} in '{manifest}': it has not ended, or name another manifest with -o")


def written_designs(
    designs: "Mapping[str, Design]", word: str, directory: Path, formats: tuple[str, ...] | None, call: Call
) -> Outcome:
    """Write designs under names that end in a word, and their CAD files where formats are given."""
    from bladewright.files.writing import write_design

    outcomes, written, failures = [], [], list[str]()
    directory.mkdir(parents=True, exist_ok=True)
    for design in designs.values():
        named: Any = design.changed("name", f"{design.name}-{word}")  # type: ignore[attr-defined]
        file = directory / f"{named.name}.toml"
        write_design(named, file)
        written.append(str(file))
        if formats:
            options = BuildOptions(
                directory=directory,
                formats=formats,
                bodies=("blade",),
                schema="AP242",
                iges_surfaces=False,
                chordal_deviation=None,
                stations=None,
                unit="mm",
                colour="parts",
                force=True,
                extend=0.0,
                fine=False,
                split=False,
                changes={},
                extents={},
            )
            with progress(options.steps, call) as bar:
                outcomes.append(build_files(file, options, bar))
    failures = [each for outcome in outcomes for each in outcome.failures]
    return Outcome(
        data={"cad": [outcome.data for outcome in outcomes], "written": written},
        text="\n".join(
            [*(outcome.text for outcome in outcomes), *([] if formats else [f"wrote {x}" for x in written])]
        ),
        failures=tuple(failures),
    )
