"""Progress of long work, on standard error and only where that is a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from bladewright.cli.options import Call


class Bar(Protocol):
    """What is used of tqdm's progress bar."""

    initial: int
    """steps that were done before the bar began"""
    n: int
    """steps that are done"""

    def set_description_str(self, text: str) -> object:
        """Show what is being done."""

    def update(self, steps: int) -> object:
        """Advance by a number of steps."""


class Silent:
    """A progress bar that shows nothing."""

    initial = n = 0

    def set_description_str(self, text: str) -> None:
        pass

    def update(self, steps: int) -> None:
        pass


@contextmanager
def progress(steps: int, call: Call, *, time_left: bool = False) -> Iterator[Bar]:
    """A progress bar of so many steps, with the time left where that is asked for; it disappears with the work."""
    if call.quiet or not sys.stderr.isatty():
        yield Silent()
        return
    from shutil import get_terminal_size

    from tqdm import tqdm

    # a terminal may say that it has no columns or lines, and tqdm would draw nothing
    size = get_terminal_size()
    form = "{desc}: {bar} {n_fmt}/{total_fmt}" + (", {remaining} left" if time_left else "")
    layout: dict[str, Any] = {"ncols": size.columns, "nrows": size.lines, "bar_format": form}
    with tqdm(total=steps, file=sys.stderr, leave=False, **layout) as bar:
        yield bar


@contextmanager
def status_line(call: Call) -> Iterator[Callable[[str], None]]:
    """A function that shows one line of text, for work whose number of steps is not known beforehand.

    The line disappears when the work is done.
    """
    if call.quiet or not sys.stderr.isatty():
        yield lambda _: None
        return

    def show(text: str) -> None:
        sys.stderr.write(f"\r\x1b[K{text}")
        sys.stderr.flush()

    try:
        yield show
    finally:
        show("")
