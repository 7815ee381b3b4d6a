"""Mass, centre and inertia of a body as rows of a table."""

from typing import Any

import numpy as np

from bladewright.views.style import per_metre, unit_name

MASSES = ("mass", "centre of mass", "inertia about its centre", "inertia about the machine axis")
"""What the table says of the mass of a body."""


def mass_rows(body: Any) -> list[tuple[str, str]]:
    """Mass, centre and inertia of a body whose design states a density; nothing of another."""
    if body.metal.density is None:
        return []
    report = body.mass_report()
    centre = ", ".join(f"{round(float(x), 9) + 0.0:.4g}" for x in per_metre() * np.real(report.centre) + 0.0)
    diagonal, around = (np.real(np.diag(each)) for each in (report.inertia, report.inertia_about_axis))
    figures = (
        f"{float(np.real(report.mass)):.5g} kg",
        f"{centre} {unit_name()}",
        f"{', '.join(f'{each:.4g}' for each in diagonal)} kg m² about x, y, z",
        f"{around[0]:.5g} kg m²",
    )
    return list(zip(MASSES, figures, strict=True))
