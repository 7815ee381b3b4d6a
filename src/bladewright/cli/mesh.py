"""`bladewright mesh`: a design becomes a volume mesh of its passage, made from the exported STEP file and measured."""

import tempfile
from pathlib import Path
from typing import Any, Literal

import click

from bladewright.cli.directory import removing_partial_files
from bladewright.cli.load_design import load_design, passage_from
from bladewright.cli.options import Call, common, design_argument, passage_options, set_option
from bladewright.cli.outcome import Outcome
from bladewright.cli.progress import progress

STEPS = 8
"""Steps of the progress bar: STEP file, geometry, edges, faces, volume, writing, reopening, measuring. Further
algorithms that are tried on the volume are not counted, as only some meshes need them."""


@click.command(short_help="Design to a volume mesh of its passage.")
@design_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="File to write, by its ending .msh, .su2 or .cgns; NAME-passage.msh where not given.",
)
@click.option(
    "--size",
    type=float,
    metavar="FRACTION",
    help="Size of elements in the open passage, of the chord; where not given, about 150,000 tetrahedra are made.",
)
@click.option(
    "--smallest",
    type=float,
    metavar="FRACTION",
    help="Smallest size at the blade's edges and gap, of the chord; a tenth of the size where not given.",
)
@click.option(
    "--curvature",
    type=float,
    default=12.0,
    show_default=True,
    metavar="N",
    help="Elements on a full circle as tight as an edge, as far as the smallest size allows.",
)
@click.option(
    "--unit", type=click.Choice(["m", "mm"]), default="m", show_default=True, help="Unit of length in the file."
)
@passage_options
@set_option
@common
@click.pass_obj
def mesh(
    call: Call,
    /,
    path: Path,
    output: Path | None,
    size: float | None,
    smallest: float | None,
    curvature: float,
    unit: Literal["m", "mm"],
    changes: dict[str, Any],
    **extents: Any,
) -> Outcome:
    """Mesh the flow passage of DESIGN with tetrahedra, from its STEP file, which gmsh reads without healing.

    Physical groups, which are the markers of SU2 and the families of CGNS, have the names of the faces; the nodes of
    periodic_upper are those of periodic_lower, turned or shifted by one pitch. The written file is reopened and
    measured: inverted elements, quality, nodes off the native surfaces, periodic partners. Where a check fails the file
    stays, and the exit status is 1. gmsh is needed: pip install 'bladewright[mesh]'.
    """
    from bladewright import meshing

    design: Any = load_design(path, changes)
    file = output or Path(f"{design.name}-passage.msh")
    meshing.check(file, size=size, smallest=smallest, curvature=curvature)
    with (
        removing_partial_files(file.parent, [file.name]),
        tempfile.TemporaryDirectory(prefix="bladewright-") as folder,
        progress(STEPS, call) as bar,
    ):

        def step(text: str) -> None:
            bar.update(1)
            bar.set_description_str(text)

        bar.set_description_str("passage")
        passage = passage_from(design, path, **extents)
        step("STEP file")
        from bladewright import cad

        step_file = Path(folder) / "passage.step"
        trip = cad.write(passage, step_file)
        report = meshing.mesh(
            step_file,
            file,
            passage=passage,
            size=size,
            smallest=smallest,
            curvature=curvature,
            unit=unit,
            progress=step,
            log=_echo if call.debug else None,
        )
    failures = (*(f"the STEP file: {text}" for text in trip.failures), *(f"{file}: {text}" for text in report.failures))
    data = {**report.to_dict(), "passed": not failures, "failures": list(failures), "name": passage.name}
    return Outcome(data=data, text=str(report), failures=failures)


def _echo(line: str) -> None:
    click.echo(line, err=True)
