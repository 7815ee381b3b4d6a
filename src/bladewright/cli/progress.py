"""Progress of long work, on standard error and only where that is a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from bladewright.cli.options import Call


class Bar(Protocol):
    """What moves a progress bar."""

    def set_description_str(self, text: str) -> object:
        """Say what is being done."""

    def update(self, steps: int) -> object:
        """Say that so many steps are done."""


class Silent:
    """A bar that shows nothing."""

    def set_description_str(self, text: str) -> None:
        pass

    def update(self, steps: int) -> None:
        pass


@contextmanager
def progress(steps: int, call: Call) -> Iterator[Bar]:
    """A bar of so many steps, gone when the work is done."""
    if call.quiet or not sys.stderr.isatty():
        yield Silent()
        return
    from tqdm import tqdm

    with tqdm(total=steps, file=sys.stderr, leave=False, bar_format="{desc}: {bar} {n_fmt}/{total_fmt}") as bar:
        yield bar


@contextmanager
def status_line(call: Call) -> Iterator[Callable[[str], None]]:
    """What says in a line how far work has come whose steps are not known before, gone when the work is done."""
    if call.quiet or not sys.stderr.isatty():
        yield lambda _: None
        return

    def say(text: str) -> None:
        sys.stderr.write(f"\r\x1b[K{text}")
        sys.stderr.flush()

    try:
        yield say
    finally:
        say("")
