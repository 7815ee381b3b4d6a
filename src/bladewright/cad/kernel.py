"""OpenCASCADE as a program: its version, and its messages kept off standard output."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version

from OCP.Message import Message


@contextmanager
def quiet() -> Iterator[None]:
    """A context in which OpenCASCADE prints nothing, because standard output belongs to the JSON of the commands."""
    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


def occ_version() -> str:
    """Version of OpenCASCADE, such as "7.9.3"."""
    for package in ("cadquery-ocp", "cadquery-ocp-novtk"):
        try:
            return ".".join(version(package).split(".")[:3])
        except PackageNotFoundError:
            continue
    return "unknown"
