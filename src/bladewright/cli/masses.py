"""Mass, centre and inertia of what a design builds, where it states a density."""

from collections.abc import Mapping
from typing import Any

Rows = list[tuple[str, str]]


def mass_data(built: Any) -> dict[str, Any]:
    """The figures of a body's mass; nothing of a passage, of a section, and of a design without a density."""
    metal = getattr(built, "metal", None)
    return {} if metal is None or metal.density is None else dict(built.mass_report().to_dict())


def mass_rows(data: Mapping[str, Any], unit: str) -> Rows:
    """The same to read, with lengths in `unit`."""
    if not data:
        return []
    from bladewright.section.checks import UNITS

    centre = ", ".join(f"{name} {x / UNITS[unit]:.6g}" for name, x in zip("xyz", data["centre_m"], strict=True))
    return [
        ("density", f"{data['density_kg_m3']:.6g} kg/m3"),
        ("mass", f"{data['mass_kg']:.6g} kg"),
        ("centre of mass", f"{centre} {unit}"),
        ("inertia about it", f"{_tensor(data['inertia_kg_m2'])} kg m2"),
        ("inertia about axis", f"{_tensor(data['inertia_about_axis_kg_m2'])} kg m2"),
    ]


def mass_texts(data: Mapping[str, Any]) -> list[str]:
    """The same in one line."""
    if not data:
        return []
    around = data["inertia_about_axis_kg_m2"][0][0]
    return [f"mass {data['mass_kg']:.6g} kg, moment of inertia about the machine axis {around:.6g} kg m2"]


def _tensor(rows: list[list[float]]) -> str:
    names = [(i, j, f"I{'xyz'[i]}{'xyz'[j]}") for i in range(3) for j in range(i, 3)]
    return ", ".join(f"{name} {rows[i][j]:.6g}" for i, j, name in names)
