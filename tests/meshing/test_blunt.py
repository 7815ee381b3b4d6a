"""A passage past blunt edges: its STEP file comes back, and its mesh has groups of the faces and strips there."""

from dataclasses import replace

import numpy as np
import pytest

import bladewright as bw
from bladewright import cad, meshing
from bladewright.blade.design.flow_path import FlowPath
from bladewright.meshing.sizes import sizes
from machines import COARSE
from machines.sectioned import PLATE, through


@pytest.fixture(scope="module")
def passage():
    plate = replace(
        PLATE,
        pitch=30.0,
        flow_path=FlowPath(hub=through((-60, 0), (120, 0)), shroud=through((-60, 25), (120, 25))),
        leading_edge=through((0, 0), (0, 25)),
        trailing_edge=through((40, 0), (40, 25)),
        tolerance=COARSE,
        section=replace(PLATE.section, thickness=0.12, stagger_angle=20.0),
    )
    return bw.passage(plate.build())


@pytest.mark.slow
@pytest.mark.usefixtures("gmsh")
def test_a_passage_past_blunt_edges_is_one_solid_and_a_mesh_with_their_groups(passage, tmp_path):
    step, mesh = tmp_path / "plate.step", tmp_path / "plate.msh"
    trip = cad.write(passage, step, samples=200)
    assert trip.passed, trip.failures
    assert {face.name for face in trip.faces} == set(passage.surfaces)
    report = meshing.mesh(step, mesh, passage=passage, size=0.4, smallest=0.05)
    assert report.passed, report.failures
    groups = {face.name for face in report.faces}
    assert {"blade_leading_edge", "hub_stagnation", "shroud_wake", "blade_trailing_edge"} <= groups


@pytest.mark.usefixtures("gmsh")
def test_a_passage_with_trimmed_walls_is_a_mesh_whose_walls_are_one_group_each(passage, tmp_path):
    step, mesh = tmp_path / "trimmed.step", tmp_path / "trimmed.msh"
    trimmed = bw.passage(passage.blade, walls="trimmed")
    trip = cad.write(trimmed, step, samples=200)
    assert trip.passed, trip.failures
    report = meshing.mesh(step, mesh, passage=trimmed, size=0.4, smallest=0.05)
    assert report.passed, report.failures
    assert {face.name for face in report.faces} == set(trimmed.surfaces) > {"hub", "shroud", "blade_trailing_edge"}
    assert report.periodic_triangles


def test_sizes_grow_away_from_the_faces_of_blunt_edges(passage):
    plan = sizes(passage, size=0.4, smallest=1e-3, curvature=12.0)
    assert [source.face for source in plan.sources] == ["blade_leading_edge", "blade_trailing_edge"]
    # as fine as on a circle as wide as the plate is thick
    thickness = 0.12 * passage.blade.chord
    assert [source.size for source in plan.sources] == pytest.approx([np.pi * thickness / 12.0] * 2, rel=1e-3)
    assert [source.extent for source in plan.sources] == pytest.approx([thickness * 0.025] * 2, rel=1e-3)
