"""What OpenCASCADE's check of the arguments of Boolean operations finds, which is FreeCAD's check of a geometry."""

from collections import Counter
from dataclasses import dataclass

from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.TopoDS import TopoDS_Shape


@dataclass(frozen=True, kw_only=True)
class KernelFault:
    """A kind of fault that OpenCASCADE finds in a shape."""

    fault: str
    """OpenCASCADE's word, such as `InvalidCurveOnSurface`: an edge is further off a face than its tolerance"""
    count: int
    """how often it is found"""

    def to_dict(self) -> dict[str, str | int]:
        """As in the round-trip report."""
        return {"fault": self.fault, "count": self.count}


def kernel_faults(shape: TopoDS_Shape, *, intersections: bool = False) -> tuple[KernelFault, ...]:
    """The faults that OpenCASCADE's argument analyser finds in a shape; none in a good one.

    These are the checks of FreeCAD's "Check Geometry", but for parts that meet where they should not: these are looked
    for on request only (`intersections`), because it takes one to ten seconds where all others take a tenth.
    """
    analyser = BOPAlgo_ArgumentAnalyzer()
    # the check may raise the tolerances of what it is given
    analyser.SetShape1(BRepBuilderAPI_Copy(shape).Shape())
    analyser.ArgumentTypeMode = True
    analyser.SelfInterMode = intersections
    analyser.SmallEdgeMode = True
    analyser.RebuildFaceMode = True
    analyser.TangentMode = True
    analyser.MergeVertexMode = True
    analyser.MergeEdgeMode = True
    analyser.ContinuityMode = True
    analyser.CurveOnSurfaceMode = True
    analyser.Perform()
    found = [result.GetCheckStatus().name for result in analyser.GetCheckResult()] if analyser.HasFaulty() else []
    counts = Counter(status.removeprefix("BOPAlgo_") for status in found)
    return tuple(KernelFault(fault=fault, count=count) for fault, count in sorted(counts.items()))
