"""Selection of parameters by patterns of their dotted paths."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from bladewright.designs import Design
from bladewright.errors import DesignError

Patterns = str | Sequence[str] | None
"""Patterns of paths, in which `*` stands for any characters, `?` for one, and brackets for themselves; None for every
parameter."""


def chosen(design: Design, free: Patterns = None) -> tuple[str, ...]:
    """The paths of `design.parameters()` that any of the patterns matches, in their order.

    Raises DesignError with the most similar path where a pattern matches none.
    """
    paths = tuple(design.parameters())
    if free is None:
        return paths
    found = {path for pattern in ([free] if isinstance(free, str) else free) for path in matching(pattern, paths)}
    if not found:
        raise DesignError("no parameter is free: give at least one pattern such as 'stagger[*]', or None for all")
    return tuple(path for path in paths if path in found)


def matching(pattern: str, paths: Iterable[str]) -> list[str]:
    """The paths that one pattern matches; raises DesignError with the most similar path where it matches none."""
    known = list(paths)
    wild = re.escape(pattern).replace(r"\*", ".*").replace(r"\?", ".")
    found = [path for path in known if re.fullmatch(wild, path)]
    if not found:
        raise DesignError(f"'{pattern}' is no parameter that is free here: {_hint(pattern, known)}")
    return found


def _hint(pattern: str, known: list[str]) -> str:
    below = [path for path in known if path.startswith((f"{pattern}[", f"{pattern}."))]
    if below:
        return f"it holds {', '.join(below[:3])}{'...' if len(below) > 3 else ''}; write '{pattern}*' for all of them"
    near = get_close_matches(pattern, known, n=1, cutoff=0.4)
    return f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known[:8])}..."
