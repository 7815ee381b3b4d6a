"""What a designer should know of the laws given at stations: where one overshoots them, and where one creases."""

from collections.abc import Mapping
from typing import Any


def law_data(design: Any) -> dict[str, Any]:
    """Overshoots, with place, value and amount in the law's unit, and creases of a design's laws; those there are."""
    from bladewright.designs import unit_at
    from bladewright.section.laws import joints_of, named_laws, overshoots_of

    overshoots, creases = list[dict[str, Any]](), list[dict[str, Any]]()
    for path, law in named_laws(design):
        unit = (unit_at(design, path) or "-").replace("length", design.length_unit)
        overshoots += [{**each._asdict(), "unit": unit} for each in overshoots_of(law, path)]
        places = [v for v, smooth in joints_of(law) if smooth == 0]
        creases += [{"law": path, "v": places}] if places else []
    found = {"overshoots": overshoots, "creases": creases}
    return {key: value for key, value in found.items() if value}


def law_rows(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The same as names and sentences."""
    rows = []
    for each in data.get("overshoots", []):
        unit = "" if each["unit"] == "-" else f" {each['unit']}"
        place = f"{each['value']:.5g}{unit} at span {each['v']:.3g}, {each['amount']:.2g}{unit} beyond both beside it"
        rows.append((each["law"], f'overshoots its stations: {place}; interpolation = "monotone" would not'))
    for each in data.get("creases", []):
        places = ", ".join(f"{v:g}" for v in each["v"])
        rows.append((each["law"], f"creases the surfaces at span {places}: it is linear between its stations"))
    return rows
