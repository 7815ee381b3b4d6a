"""The process that loads gmsh: `python -m bladewright.meshing.worker DIRECTORY` reads the job there, and answers there.

For seconds at a time gmsh lets no signal reach Python, and it ends its process where it fails badly. A process of its
own keeps both from the caller.
"""

import sys
from pathlib import Path

import numpy as np

from bladewright.errors import MeshError
from bladewright.meshing.gmsh_process import CONTENT_FILE, Answer, Job


def main(directory: Path) -> None:
    """Make the mesh that the job in a directory asks for, write it, reopen it, and answer."""
    try:
        import gmsh
    except (ImportError, OSError) as error:
        Answer(error=_unloadable(error)).write(directory)
        return
    # SIGINT ends this process at once; the parent handles it in its own way.
    gmsh.initialize(interruptible=True, readConfigFiles=False)
    try:
        answer = _answer(Job.read(directory), directory)
    except MeshError as error:
        answer = Answer(error=str(error))
    except Exception as error:  # noqa: BLE001  gmsh has no types of errors
        answer = Answer(error=f"gmsh gives up: {error}; try another size")
    finally:
        gmsh.finalize()
    answer.write(directory)


def _answer(job: Job, directory: Path) -> Answer:
    """Make the mesh, write it, read it back from disk, and say how it was made."""
    import gmsh

    from bladewright.meshing import generation, gmsh_model
    from bladewright.meshing.mesh_file import read_mesh, write_mesh

    gmsh_model.set_options(gmsh_model.QUIET)
    generation.report_step("geometry")
    faces = gmsh_model.open_step(job)
    followers = gmsh_model.set_periodic(job, faces)
    gmsh_model.name_groups(faces)
    gmsh_model.set_sizes(job, faces)
    generation.mesh_curves()
    surface = generation.mesh_faces(followers)
    volume = generation.mesh_volume()
    generation.place_periodic_nodes(followers, job.motion)
    answer = Answer(
        gmsh=gmsh.__version__,
        surface=surface,
        volume=volume,
        nodes=len(gmsh.model.mesh.getNodes()[0]),
        tetrahedra=len(gmsh.model.mesh.getElements(3)[1][0]),
    )
    generation.report_step("writing")
    write_mesh(Path(job.mesh), job.scale)
    generation.report_step("reopening")
    np.savez(directory / CONTENT_FILE, **read_mesh(Path(job.mesh)))
    return answer


def _unloadable(error: Exception) -> str:
    if isinstance(error, ImportError):
        return "gmsh is not installed, which meshes the passage: pip install 'bladewright[mesh]'"
    return (
        f"gmsh is installed, but a library of the system that it needs is not: {error}; on Debian and Ubuntu "
        "apt-get install libglu1-mesa libxcursor1 libxft2 libxinerama1"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
