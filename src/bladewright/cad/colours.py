"""The colours of faces in STEP and IGES files: one for each part of a blade and of its passage."""

import re

from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB

from bladewright.cad.native_body import ClosedBody
from bladewright.errors import CadError

COLOURS = {
    "suction side": "#4477aa",
    "pressure side": "#cc5544",
    "upper side": "#bbaa99",
    "lower side": "#887766",
    "edge": "#ddaa33",
    "fillet": "#66bbaa",
    "tip": "#aa7744",
    "hub": "#777777",
    "shroud": "#bbbbbb",
    "inlet": "#55aa55",
    "outlet": "#aa3377",
    "periodic boundary": "#88ccee",
    "disc": "#999988",
}
"""sRGB colour by the part that a face belongs to. Suction is blue and pressure red, as on plots of the pressure
coefficient; the pairs that meet at an edge differ in lightness too, for those who do not tell red from green."""

_PARTS = {
    r"fillet": "fillet",
    r"^(periodic|cyclic)_": "periodic boundary",
    r"^inlet": "inlet",
    r"^outlet": "outlet",
    r"^hub": "hub",
    r"^shroud": "shroud",
    r"(^|_)(leading|trailing)_edge": "edge",
    r"(^|_)tip": "tip",
    r"(^|_)hub": "hub",
    r"(^|_)shroud": "shroud",
}
"""Part by a pattern of the face's name (docs/nomenclature.md); the first that is found counts."""


def face_colours(body: ClosedBody, colour: str) -> dict[str, str]:
    """The colour `#rrggbb` of each face of a body, by name.

    `colour` is "parts" for those of `COLOURS`, one colour such as "#8899aa" for all faces, or "none". Raises CadError
    for anything else.
    """
    check_colour(colour)
    if colour == "none":
        return {}
    if colour != "parts":
        return dict.fromkeys(body.surfaces, colour)
    suction = suction_side(body)
    return {name: COLOURS[part_of(name, suction)] for name in body.surfaces}


def check_colour(colour: str) -> None:
    """Raise CadError unless it is "parts", "none" or a colour such as "#8899aa"."""
    if colour not in {"parts", "none"} and not re.fullmatch(r"#[0-9a-fA-F]{6}", colour):
        raise CadError(
            f"the colour {colour!r} is none that faces can have: give red, green and blue as in '#8899aa', 'parts' for "
            "a colour for each part of the blade, or 'none'"
        )


def part_of(face: str, suction: str | None) -> str:
    """The part that a face belongs to, a key of `COLOURS`; `suction` is the suction side, where it is known.

    A strip is a part of its side.
    """
    face = re.sub(r"(hub|shroud)_strip_", "", face)
    found = (part for pattern, part in _PARTS.items() if re.search(pattern, face))
    part = next(found, None)
    if part is not None:
        return part
    side = re.search(r"(?:^|_)(upper|lower)(?:_|$)", face)
    if side is None:
        return "disc"
    if suction is None:
        return f"{side[1]} side"
    return "suction side" if side[1] == suction else "pressure side"


def suction_side(body: object) -> str | None:
    """The suction side of a blade, or of the blade in a passage; None where its camber and rotation do not tell."""
    side: str | None = getattr(getattr(body, "blade", body), "suction_side", None)
    return side


def occ_colour(colour: str) -> Quantity_Color:
    """A colour `#rrggbb` as OpenCASCADE has it."""
    red, green, blue = (int(colour[place : place + 2], 16) / 255.0 for place in (1, 3, 5))
    return Quantity_Color(red, green, blue, Quantity_TOC_sRGB)
