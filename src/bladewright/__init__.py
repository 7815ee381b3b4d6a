"""Turbomachinery blades as native NURBS, exported as solids that are reopened and measured.

The public names load on first use, so that `import bladewright` costs milliseconds; `bladewright.cad` is the first
name that loads OpenCASCADE.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bladewright import cad as cad
    from bladewright import meshing as meshing
    from bladewright.blade.design.families import CamberAngleBlade as CamberAngleBlade
    from bladewright.blade.design.families import CurvatureMeanlineBlade as CurvatureMeanlineBlade
    from bladewright.blade.design.families import ProfileBlade as ProfileBlade
    from bladewright.blade.design.families import SuctionPressureBlade as SuctionPressureBlade
    from bladewright.blade.design.families import WedgeDiffuserBlade as WedgeDiffuserBlade
    from bladewright.blade.design.families import prismatic as prismatic
    from bladewright.blade.design.flow_path import Channel as Channel
    from bladewright.blade.design.flow_path import FlowPath as FlowPath
    from bladewright.blade.design.meridional_curve import ControlPolygon as ControlPolygon
    from bladewright.blade.design.meridional_curve import StraightsAndArcs as StraightsAndArcs
    from bladewright.blade.design.meridional_curve import ThroughPoints as ThroughPoints
    from bladewright.blade.design.stacking import Stacking as Stacking
    from bladewright.blade.design.unified import UnifiedBlade as UnifiedBlade
    from bladewright.blade.native.blade import Blade as Blade
    from bladewright.blade.native.throat import Throat as Throat
    from bladewright.blade.native.throat import throat as throat
    from bladewright.derivatives.net_jacobian import NetJacobian as NetJacobian
    from bladewright.derivatives.net_jacobian import net_jacobian as net_jacobian
    from bladewright.derivatives.net_jacobian import pullback as pullback
    from bladewright.derivatives.sensitivity import sensitivity as sensitivity
    from bladewright.derivatives.surface_points import SurfacePoints as SurfacePoints
    from bladewright.derivatives.surface_points import placed_points as placed_points
    from bladewright.derivatives.surface_points import surface_points as surface_points
    from bladewright.derivatives.variables import Variables as Variables
    from bladewright.derivatives.variables import variables as variables
    from bladewright.domain.build import passage as passage
    from bladewright.domain.passage import Passage as Passage
    from bladewright.domain.section import SectionPassage as SectionPassage
    from bladewright.domain.section import section_passage as section_passage
    from bladewright.errors import BladewrightError as BladewrightError
    from bladewright.errors import CadError as CadError
    from bladewright.errors import DerivativeError as DerivativeError
    from bladewright.errors import DesignError as DesignError
    from bladewright.errors import FileError as FileError
    from bladewright.errors import FitError as FitError
    from bladewright.errors import GeometryError as GeometryError
    from bladewright.errors import MeshError as MeshError
    from bladewright.files.clouds import read_cloud as read_cloud
    from bladewright.files.imported import Imported as Imported
    from bladewright.files.parablade import import_parablade as import_parablade
    from bladewright.files.parablade import read_parablade as read_parablade
    from bladewright.files.reading import read_design as read_design
    from bladewright.files.su2 import read_surface_points as read_surface_points
    from bladewright.files.su2 import read_surface_sensitivity as read_surface_sensitivity
    from bladewright.files.su2 import write_surface_points as write_surface_points
    from bladewright.files.tblade3 import import_tblade3 as import_tblade3
    from bladewright.files.writing import write_design as write_design
    from bladewright.fitting.assessment.result import Fit as Fit
    from bladewright.fitting.fit import fit as fit
    from bladewright.fitting.freeform.curves import CurveFit as CurveFit
    from bladewright.fitting.freeform.curves import fit_curve as fit_curve
    from bladewright.fitting.freeform.profile import ProfileFit as ProfileFit
    from bladewright.fitting.freeform.profile import fit_profile as fit_profile
    from bladewright.fitting.freeform.surfaces import SurfaceFit as SurfaceFit
    from bladewright.fitting.freeform.surfaces import fit_surface as fit_surface
    from bladewright.nurbs.curve import Curve as Curve
    from bladewright.nurbs.surface import Surface as Surface
    from bladewright.nurbs.trimmed import TrimmedSurface as TrimmedSurface
    from bladewright.section.camber_angle import CamberAngle as CamberAngle
    from bladewright.section.camber_angle import CamberAngleSection as CamberAngleSection
    from bladewright.section.curvature_meanline import CurvatureMeanline as CurvatureMeanline
    from bladewright.section.curvature_meanline import CurvatureMeanlineSection as CurvatureMeanlineSection
    from bladewright.section.profiles.c4 import C4 as C4
    from bladewright.section.profiles.circular_arc import DoubleCircularArc as DoubleCircularArc
    from bladewright.section.profiles.circular_arc import MultipleCircularArc as MultipleCircularArc
    from bladewright.section.profiles.flat_plate import FlatPlate as FlatPlate
    from bladewright.section.profiles.kinds import ProfileSection as ProfileSection
    from bladewright.section.profiles.naca4 import Naca4 as Naca4
    from bladewright.section.profiles.naca5 import Naca5 as Naca5
    from bladewright.section.profiles.naca6 import Naca6 as Naca6
    from bladewright.section.profiles.naca65 import Naca65 as Naca65
    from bladewright.section.profiles.points import PointsProfile as PointsProfile
    from bladewright.section.suction_pressure.part import SuctionPressure as SuctionPressure
    from bladewright.section.suction_pressure.part import SuctionPressureSection as SuctionPressureSection
    from bladewright.section.thickness.modified_naca import ModifiedNaca as ModifiedNaca
    from bladewright.section.thickness.quartic import QuarticSpline as QuarticSpline
    from bladewright.section.thickness.wennerstrom import Wennerstrom as Wennerstrom
    from bladewright.section.unified import UnifiedSection as UnifiedSection
    from bladewright.section.wedge_diffuser import WedgeDiffuser as WedgeDiffuser
    from bladewright.section.wedge_diffuser import WedgeDiffuserSection as WedgeDiffuserSection

__version__ = "0.1.0"

_HOMES = {
    "Blade": "blade.native.blade",
    "BladewrightError": "errors",
    "C4": "section.profiles.c4",
    "CadError": "errors",
    "CamberAngle": "section.camber_angle",
    "CamberAngleBlade": "blade.design.families",
    "CamberAngleSection": "section.camber_angle",
    "Channel": "blade.design.flow_path",
    "ControlPolygon": "blade.design.meridional_curve",
    "CurvatureMeanline": "section.curvature_meanline",
    "CurvatureMeanlineBlade": "blade.design.families",
    "CurvatureMeanlineSection": "section.curvature_meanline",
    "Curve": "nurbs.curve",
    "CurveFit": "fitting.freeform.curves",
    "DerivativeError": "errors",
    "DesignError": "errors",
    "DoubleCircularArc": "section.profiles.circular_arc",
    "FileError": "errors",
    "Fit": "fitting.assessment.result",
    "FitError": "errors",
    "FlatPlate": "section.profiles.flat_plate",
    "FlowPath": "blade.design.flow_path",
    "GeometryError": "errors",
    "Imported": "files.imported",
    "MeshError": "errors",
    "ModifiedNaca": "section.thickness.modified_naca",
    "MultipleCircularArc": "section.profiles.circular_arc",
    "Naca4": "section.profiles.naca4",
    "Naca5": "section.profiles.naca5",
    "Naca6": "section.profiles.naca6",
    "Naca65": "section.profiles.naca65",
    "NetJacobian": "derivatives.net_jacobian",
    "Passage": "domain.passage",
    "PointsProfile": "section.profiles.points",
    "ProfileBlade": "blade.design.families",
    "ProfileFit": "fitting.freeform.profile",
    "ProfileSection": "section.profiles.kinds",
    "QuarticSpline": "section.thickness.quartic",
    "SectionPassage": "domain.section",
    "Stacking": "blade.design.stacking",
    "StraightsAndArcs": "blade.design.meridional_curve",
    "SuctionPressure": "section.suction_pressure.part",
    "SuctionPressureBlade": "blade.design.families",
    "SuctionPressureSection": "section.suction_pressure.part",
    "Surface": "nurbs.surface",
    "SurfaceFit": "fitting.freeform.surfaces",
    "SurfacePoints": "derivatives.surface_points",
    "Throat": "blade.native.throat",
    "ThroughPoints": "blade.design.meridional_curve",
    "TrimmedSurface": "nurbs.trimmed",
    "UnifiedBlade": "blade.design.unified",
    "UnifiedSection": "section.unified",
    "Variables": "derivatives.variables",
    "WedgeDiffuser": "section.wedge_diffuser",
    "WedgeDiffuserBlade": "blade.design.families",
    "WedgeDiffuserSection": "section.wedge_diffuser",
    "Wennerstrom": "section.thickness.wennerstrom",
    "fit": "fitting.fit",
    "fit_curve": "fitting.freeform.curves",
    "fit_profile": "fitting.freeform.profile",
    "fit_surface": "fitting.freeform.surfaces",
    "import_parablade": "files.parablade",
    "import_tblade3": "files.tblade3",
    "net_jacobian": "derivatives.net_jacobian",
    "passage": "domain.build",
    "placed_points": "derivatives.surface_points",
    "prismatic": "blade.design.families",
    "pullback": "derivatives.net_jacobian",
    "read_cloud": "files.clouds",
    "read_design": "files.reading",
    "read_parablade": "files.parablade",
    "read_surface_points": "files.su2",
    "read_surface_sensitivity": "files.su2",
    "section_passage": "domain.section",
    "sensitivity": "derivatives.sensitivity",
    "surface_points": "derivatives.surface_points",
    "throat": "blade.native.throat",
    "variables": "derivatives.variables",
    "write_design": "files.writing",
    "write_surface_points": "files.su2",
}
_ROOMS = ("cad", "meshing")

__all__ = ["__version__", *_ROOMS, *_HOMES]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(importlib.import_module(f"bladewright.{_HOMES[name]}"), name)
    elif name in _ROOMS:
        value = importlib.import_module(f"bladewright.{name}")
    else:
        raise AttributeError(f"module 'bladewright' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
