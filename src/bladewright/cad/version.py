"""Which OpenCASCADE does the work."""

from importlib.metadata import PackageNotFoundError, version


def occ_version() -> str:
    """Version of the OpenCASCADE kernel, such as "7.9.3"."""
    for package in ("cadquery-ocp", "cadquery-ocp-novtk"):
        try:
            return ".".join(version(package).split(".")[:3])
        except PackageNotFoundError:
            continue
    return "unknown"
