"""The report on a mesh file: what it holds and how good it is, measured on the file."""

from dataclasses import asdict, dataclass
from typing import Any

from bladewright.meshing.periodicity import MISMATCH

FLAT = 0.0
"""minSICN that every tetrahedron must exceed: at zero it is flat, and its Jacobian is singular."""


@dataclass(frozen=True, kw_only=True)
class FaceMesh:
    """The triangles of one physical group."""

    name: str
    triangles: int
    nodes: int
    max_deviation_mm: float
    """largest distance of a node from the native surface"""
    mean_deviation_mm: float


@dataclass(frozen=True, kw_only=True)
class Quality:
    """A measure of the tetrahedra: 1 regular, 0 flat, negative inverted."""

    worst: float
    percentile: float
    """the value that one in a hundred lies below"""
    mean: float


@dataclass(frozen=True, kw_only=True)
class MeshReport:
    """A mesh file, reopened from disk and measured."""

    file: str
    format: str
    unit: str
    """unit of length in the file"""
    tetrahedra: int
    nodes: int
    inverted: int
    """number of tetrahedra whose Jacobian is not positive"""
    min_sicn: Quality
    """signed inverse condition number of the map from the regular tetrahedron"""
    gamma: Quality
    """three times the inscribed over the circumscribed radius"""
    faces: tuple[FaceMesh, ...]
    deviation_limit_mm: float
    loose: int
    """number of facets that belong to one tetrahedron and to no triangle of a group, and of triangles on no facet"""
    periodic_nodes: int
    """number of pairs of nodes on the periodic boundaries"""
    periodic_mismatch: float
    """largest distance of a node from its partner's image, in pitches"""
    periodic_triangles: bool
    """whether the triangles of the periodic boundaries correspond as well"""
    rotation_deg: float
    """rotation from the lower periodic boundary to the upper one, right-handed about +x"""
    translation: tuple[float, float, float]
    """translation between them in a linear cascade, in the file's unit"""
    volume_error: float
    """relative difference from the native volume, which flat facets do not fill"""
    size: float
    """size in the open passage, in chords"""
    smallest: float
    """smallest size, in chords"""
    expected: int
    """number of tetrahedra expected"""
    gmsh: str
    """version of gmsh"""
    algorithms: tuple[str, ...]
    """algorithms that meshed the faces, then the volume, and those that improved it"""
    seconds: float
    """time that the mesh took, without measuring"""

    @property
    def failures(self) -> tuple[str, ...]:
        """A line for each check that failed."""
        messages = []
        if self.inverted:
            messages.append(
                f"{self.inverted} of {self.tetrahedra} tetrahedra are inverted or flat, the worst minSICN is "
                f"{self.min_sicn.worst:.3g}: choose another size"
            )
        if self.loose:
            messages.append(f"{self.loose} facets on the boundary do not match a named face")
        messages += [
            f"{face.name}: nodes lie up to {face.max_deviation_mm:.3g} mm off the native surface, at most "
            f"{self.deviation_limit_mm:.3g} mm is allowed"
            for face in self.faces
            if not face.max_deviation_mm <= self.deviation_limit_mm
        ]
        if not self.periodic_mismatch <= MISMATCH:
            messages.append(
                f"periodic nodes are {self.periodic_mismatch:.3g} of the pitch off their partners, at most "
                f"{MISMATCH:g} is allowed"
            )
        elif not self.periodic_triangles:
            messages.append("the triangles of the periodic boundaries are not partners, though their nodes are")
        return tuple(messages)

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return not self.failures

    @property
    def su2_marker(self) -> str:
        """The line of an SU2 configuration that couples the periodic markers."""
        numbers = [0.0, 0.0, 0.0, self.rotation_deg, 0.0, 0.0, *self.translation]
        return f"MARKER_PERIODIC= ( periodic_lower, periodic_upper, {', '.join(f'{n:.13g}' for n in numbers)} )"

    def to_dict(self) -> dict[str, Any]:
        """All figures with the limits and failures, for JSON."""
        return {
            **asdict(self),
            "limits": {"min_sicn": FLAT, "deviation_mm": self.deviation_limit_mm, "periodic_mismatch": MISMATCH},
            "passed": self.passed,
            "failures": list(self.failures),
            **({"su2": self.su2_marker} if self.format == "SU2" else {}),
        }

    def __str__(self) -> str:
        width = max(len(face.name) for face in self.faces)
        lines = [
            f"{self.file} ({self.format}, {self.unit}): {'passed' if self.passed else 'FAILED'}",
            f"  {self.tetrahedra} tetrahedra, {self.nodes} nodes, {self.inverted} inverted",
            f"  size {self.size:.3g} to {self.smallest:.3g} of the chord, {self.expected} tetrahedra expected",
            *(
                f"  {name}, 1 of a regular tetrahedron: worst {each.worst:.3f}, 1 % below {each.percentile:.3f}, "
                f"mean {each.mean:.3f}"
                for name, each in (("minSICN", self.min_sicn), ("gamma", self.gamma))
            ),
            *(
                f"  {face.name:<{width}}  {face.triangles} triangles, {face.nodes} nodes up to "
                f"{face.max_deviation_mm:.2g} mm off the native surface"
                for face in self.faces
            ),
            f"  periodic: {self.periodic_nodes} pairs of nodes, {self.periodic_mismatch:.2g} of the pitch apart",
            f"  volume {100.0 * self.volume_error:+.2g} % off the native one, which flat triangles do not fill",
            f"  gmsh {self.gmsh}: {', '.join(self.algorithms)}; meshed in {self.seconds:.1f} s",
            *([f"  {self.su2_marker}"] if self.format == "SU2" else []),
            *(f"  FAILED: {failure}" for failure in self.failures),
        ]
        return "\n".join(lines)
