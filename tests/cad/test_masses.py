"""Masses against OpenCASCADE's."""

import numpy as np
import pytest
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps

import bladewright as bw
from bladewright.cad.placement import location
from bladewright.cad.solids import occ_solid
from machines.coarse import ROTOR

DENSITY = 8190.0
"""of nickel alloy 718 [kg/m^3]"""


@pytest.fixture(scope="module")
def row():
    return bw.row(ROTOR.changed("density", DENSITY).build(), 3)


def test_mass_centre_and_inertia_are_those_of_opencascade(row):
    part, whole, one = occ_solid(row.blade).solid, GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(part, one, 1e-9)
    for place in row.placements:
        copy = GProp_GProps()
        BRepGProp.VolumeProperties_s(part.Moved(location(place)), copy, 1e-9)
        whole.Add(copy)
    for body, found in ((row.blade, one), (row, whole)):
        report = body.mass_report()
        centre, tensor = found.CentreOfMass(), found.MatrixOfInertia()
        np.testing.assert_allclose(report.mass, DENSITY * 1e-9 * found.Mass(), rtol=1e-6)
        np.testing.assert_allclose(report.centre, np.array(centre.Coord()) * 1e-3, atol=1e-7)
        about = DENSITY * 1e-15 * np.array([[tensor.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
        np.testing.assert_allclose(report.inertia, about, atol=2e-6 * np.trace(about))
        axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(1.0, 0.0, 0.0))
        np.testing.assert_allclose(
            report.inertia_about_axis[0, 0], DENSITY * 1e-15 * found.MomentOfInertia(axis), rtol=1e-6
        )
