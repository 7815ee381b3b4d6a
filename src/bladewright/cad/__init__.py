"""Solids, CAD files and their round trips: the only room that loads OpenCASCADE."""

from bladewright.cad.built import Built as Built
from bladewright.cad.roundtrip import RoundTrip as RoundTrip
from bladewright.cad.sample import sample as sample
from bladewright.cad.solid import solid as solid
from bladewright.cad.verify import verify as verify
from bladewright.cad.version import occ_version as occ_version
from bladewright.cad.write import write as write
