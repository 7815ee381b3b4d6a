"""Solids, CAD files and their round trips: the only room that loads OpenCASCADE."""

from bladewright.cad.built import Built as Built
from bladewright.cad.cutting import CutPassage as CutPassage
from bladewright.cad.cutting import cut_passage as cut_passage
from bladewright.cad.cutting import write_cut as write_cut
from bladewright.cad.roundtrip import RoundTrip as RoundTrip
from bladewright.cad.sampling import sample as sample
from bladewright.cad.solids import solid as solid
from bladewright.cad.verification import verify as verify
from bladewright.cad.version import occ_version as occ_version
from bladewright.cad.writing import write as write
