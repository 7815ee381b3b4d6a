"""OpenCASCADE without its chatter: nothing of it reaches standard output, which belongs to the user's JSON."""

from collections.abc import Iterator
from contextlib import contextmanager

from OCP.Message import Message


@contextmanager
def quiet() -> Iterator[None]:
    """A block in which the kernel's messages go nowhere; its printers are put back afterwards."""
    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)
