"""The design of a file with changes by path, of which some fill tables that the file does not have."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from bladewright.designs import Part
from bladewright.files.reading import design_from


def changed_design(document: Mapping[str, Any], where: str, changes: Mapping[str, Any]) -> Any:
    """The design in the tables of a file, with other values by path.

    A change such as `hub_fillet.radius` of a design without that table makes the table, as if the file had it; so does
    one whose value is a table. `where` names the file. Raises DesignError as `design_from` and `changed` do.
    """
    design = design_from(document, where)
    made = {path: value for path, value in changes.items() if isinstance(value, Mapping) or _lacks_table(design, path)}
    if made:
        design = design_from(_with_tables(document, made), where)
    rest = {path: value for path, value in changes.items() if path not in made}
    return design.changed(rest) if rest else design


def _lacks_table(design: Any, path: str) -> bool:
    """Whether a path leads into a table that the design could have and does not."""
    node = design
    for name in path.split(".")[:-1]:
        if node is None:
            return True
        if not isinstance(node, Part):
            return False
        node = getattr(node, name, path)
    return node is None


def _with_tables(document: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    tables = deepcopy(dict(document))
    for path, value in changes.items():
        *names, last = path.split(".")
        node = tables
        for name in names:
            node = node.setdefault(name, {})
        node[last] = value
    return tables
