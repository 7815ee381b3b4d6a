"""Reading a T-Blade3 case: its main input file, and the file of control points in the same directory."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from bladewright.errors import FileError
from bladewright.files.tblade3.case import TBlade3Case
from bladewright.files.tblade3.control_inputs import read_sectionwise, read_spanwise
from bladewright.files.tblade3.fortran_input import InputLines
from bladewright.files.tblade3.main_input import read_head, read_tables
from bladewright.files.tblade3.remarks import notes_of, unsupported_of, unused_of
from bladewright.files.text import read_text

MAIN = "3dbgbinput"
"""Name of the main input file, before the suffix of the blade row."""
COMPANIONS = ("spancontrolinputs", "controlinputs")
"""Names of the files of control points, along the span and section by section."""
_TITLES = (
    *("blade row", "blade scaling factor", "sectionwise properties", "airfoil camber", "airfoil thickness"),
    *("control points for sweep", "control points for lean", "streamline data", "x_s"),
)


def is_tblade3(text: str) -> bool:
    """Whether a text looks like T-Blade3's main input file."""
    small = text.lower()
    return sum(title in small for title in _TITLES) >= 4


def read_tblade3(path: str | os.PathLike[str]) -> TBlade3Case:
    """The case of a main input file `3dbgbinput.R.dat` and of the file of control points in the same directory.

    The latter is `spancontrolinputs.R.dat` where the camber switch says `spanwise_spline`, else `controlinputs.R.dat`
    where camber, thickness multiplier or leading edge need one. Raises FileError, naming file and line, where one is
    missing or cut short, or asks for what T-Blade3 does not know or no longer has.
    """
    path = Path(path)
    for name in COMPANIONS:
        if path.name.lower().startswith(f"{name}."):
            raise FileError(
                f"'{path}' holds control points only: name the main input file that goes with it, such as "
                f"'{path.with_name(f'3dbgbinput.{_suffix(path)}.dat')}'"
            )
    notes: list[str] = []
    lines = InputLines(read_text(path), path)
    found = read_head(lines, notes)
    count = found.pop("streamline_count")
    found |= read_tables(lines, count, notes, early=found.pop("early"))
    grid = found.pop("grid_columns")
    control, companion = _control_points(path, found, count)
    case = TBlade3Case(
        file=str(path),
        companion=str(companion) if companion else None,
        suffix=_suffix(path),
        **{**dict.fromkeys(("meanlines", "naca", "multipliers", "leading_edges")), **control},
        **found,
    )
    return replace(
        case,
        unused=unused_of(case, grid=grid),
        unsupported=unsupported_of(case),
        notes=(*notes, *notes_of(case)),
    )


def _control_points(path: Path, found: dict[str, Any], count: int) -> tuple[dict[str, Any], Path | None]:
    needed = {"multiplier": found["thickness_multiplier"], "leading_edge": found["leading_edge"] == "spline"}
    naca = found["thickness"] == "naca"
    if naca and not found["spanwise"]:
        raise FileError(
            f"'{path}' has the thickness switch 5 without 'spanwise_spline' behind the camber switch: that thickness "
            f"is read from '{COMPANIONS[0]}.{_suffix(path)}.dat' only; write the word on line 14"
        )
    if naca and needed["leading_edge"]:
        raise FileError(
            f"'{path}' has the leading-edge switch 1 with the thickness switch 5: its file has no table of "
            "leading edges, which are those of the thickness itself; set the leading-edge switch, line 20, to 0"
        )
    if naca:
        needed["multiplier"] = False
    if found["spanwise"]:
        companion = _companion(path, COMPANIONS[0], "the camber switch says 'spanwise_spline'")
        return read_spanwise(InputLines(read_text(companion), companion), naca=naca, **needed), companion
    needed["curvature"] = found["curvature_camber"]
    if not any(needed.values()):
        return {}, None
    reasons = {
        "curvature": "the camber is defined by its curvature",
        "multiplier": "the thickness has a multiplier",
        "leading_edge": "the leading edge is a spline",
    }
    companion = _companion(path, COMPANIONS[1], next(reasons[each] for each in reasons if needed[each]))
    return read_sectionwise(InputLines(read_text(companion), companion), count, **needed), companion


def _suffix(path: Path) -> str:
    """The part of a file's name between its last two dots."""
    return path.stem.rpartition(".")[2] if "." in path.stem else ""


def _companion(path: Path, kind: str, reason: str) -> Path:
    """The file of control points of a kind that belongs to a main input file, found by the suffix of its name."""
    suffix = _suffix(path)
    if not suffix:
        raise FileError(
            f"'{path}' needs a file '{kind}.R.dat' beside it, as {reason}; R is what stands between the last two dots "
            "of the main file's name, which has none: name it 3dbgbinput.R.dat, such as 3dbgbinput.1.dat"
        )
    wanted = f"{kind}.{suffix}.dat"
    exact = path.with_name(wanted)
    if exact.is_file():
        return exact
    try:
        names = sorted(each.name for each in path.parent.iterdir())
    except OSError:
        names = []
    for name in names:
        if name.lower() == wanted.lower():
            return path.with_name(name)
    others = [name for name in names if name.lower().startswith(tuple(f"{each}." for each in COMPANIONS))]
    hint = f"; beside it are {', '.join(others[:5])}" if others else ""
    raise FileError(f"'{path}' needs the file '{exact}', as {reason}: there is none{hint}")
