"""Turbomachinery blades from engineering parameters to NURBS surfaces, CAD files, passages, meshes and derivatives.

    import bladewright as bw
    from bladewright import cad

    design = bw.read_design("fan-rotor.toml")       # a frozen record of numbers
    design = design.changed("stagger[1]", 25.0)     # a new design
    blade = design.build()                          # NURBS surfaces, in metres
    trip = cad.write(blade, "fan-rotor.step")       # written, reopened, measured

Help on one name: help(bladewright.fit). The pages in docs/ go task by task.

Design files     read_design, write_design; design_from_table (TableDesign)
Blades           UnifiedBlade in a Channel; CurvatureMeanlineBlade, SuctionPressureBlade, CamberAngleBlade,
                 ProfileBlade, SegmentedBlade, WedgeDiffuserBlade in a FlowPath with Stacking; prismatic
Meridional       ThroughPoints, ControlPolygon, StraightsAndArcs
As a part        Fillet with FilletRadii; Cut of AtRadius, AtX or a meridional curve; Disc with an Outline
2D sections      UnifiedSection, CurvatureMeanlineSection, SuctionPressureSection, CamberAngleSection, ProfileSection,
                 SegmentedSection, WedgeDiffuserSection
Parts of them    CurvatureMeanline, SuctionPressure, CamberAngle, WedgeDiffuser
Laws by values   Stations
Thickness laws   ModifiedNaca, QuarticSpline, Wennerstrom
Profiles         Naca4, Naca5, Naca6, Naca65, C4, DoubleCircularArc, MultipleCircularArc, FlatPlate, PointsProfile,
                 Segmented of AirfoilSide, Segment, SegmentJoint, Nose, Skin and Morph
What is built    Blade of Surface and TrimmedSurface, Curve; passage gives a Passage, section_passage a SectionPassage,
                 row a Row, sector a Sector, wheel a Wheel, throat a Throat; blade.report() the station table
Polars           polar (Polar) of a section or an Airfoil, airfoil_of
Derivatives      sensitivity, net_jacobian (NetJacobian), pullback, variables (Variables)
With SU2         surface_points, placed_points (SurfacePoints), read_surface_points, write_surface_points,
                 read_surface_sensitivity
Matching         read_cloud, fit (Fit); fit_curve (CurveFit), fit_surface (SurfaceFit), fit_profile (ProfileFit)
Imports          import_parablade, import_tblade3 (Imported), read_parablade
Studies          sweep (Runs), optimise (Optimum, ParetoSet), OperatingPoint, openmdao_component
CAD files        cad.write, cad.verify, cad.made_from, cad.solid, cad.sample, cad.cut_passage; design_origin (Origin)
Meshes           meshing.mesh
Errors           BladewrightError and its kinds: DesignError, GeometryError, FileError, CadError, FitError, MeshError,
                 DerivativeError, PolarError, StudyError

Names load on first use, so importing bladewright takes milliseconds. Only bladewright.cad loads OpenCASCADE.
"""

import sys

import lazy_loader

from bladewright.display import drawn_by

__version__ = "0.1.0"

__getattr__, _names, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]
drawn_by("bladewright.views.shown")


def __dir__() -> list[str]:
    # pydoc asks inspect for members and prints every class in full, 5,500 lines; the text above is its map of the names
    asked_by = sys._getframe(1).f_globals.get("__name__")  # noqa: SLF001  nothing else tells help() from completion
    return ["__version__"] if asked_by == "inspect" else sorted([*_names(), "__version__"])
