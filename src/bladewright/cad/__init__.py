"""Solids, CAD files and their round trips; nothing else in bladewright loads OpenCASCADE."""

from typing import Any
from warnings import warn

from bladewright.cad.colours import COLOURS as COLOURS
from bladewright.cad.cutting import CutPassage as CutPassage
from bladewright.cad.cutting import cut_passage as cut_passage
from bladewright.cad.cutting import write_cut as write_cut
from bladewright.cad.kernel import occ_version as occ_version
from bladewright.cad.made_from import MadeFrom as MadeFrom
from bladewright.cad.made_from import made_from as made_from
from bladewright.cad.native_body import NativeBody as NativeBody
from bladewright.cad.round_trip import RoundTrip as RoundTrip
from bladewright.cad.sampling import sample as sample
from bladewright.cad.solids import solid as solid
from bladewright.cad.verification import verify as verify
from bladewright.cad.writing import write as write


def __getattr__(name: str) -> Any:
    if name == "Built":
        warn("bladewright.cad.Built is called NativeBody now", DeprecationWarning, stacklevel=2)
        return NativeBody
    raise AttributeError(f"module 'bladewright.cad' has no attribute '{name}'")
