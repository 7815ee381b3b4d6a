"""A centrifugal impeller by camber angle, cut off at the exit: exit radius, backsweep, thickness of the blunt edge."""

import numpy as np
from _common import example, export

blade = example("backswept-impeller").build()
export(blade.design, blade)

v = np.linspace(0.0, 1.0, 21)
ends = [np.moveaxis(blade.surfaces[side](1.0, v), -1, 0) for side in ("upper", "lower")]
radius = np.hypot(*np.mean(ends, axis=0)[1:])
thickness = np.sqrt(np.sum((ends[0] - ends[1]) ** 2, axis=0))
backsweep = [np.degrees(section.metal_angle_out) for section in blade.sections]
print(
    f"exit radius {1e3 * radius.mean():.3f} mm, backsweep {-np.mean(backsweep):.4f} deg, "
    f"edge {1e3 * thickness.min():.3f} to {1e3 * thickness.max():.3f} mm thick"
)

# the middle of the chord lies on the cylinder; the face between its corners is a chord of it
assert np.max(np.abs(radius - 0.1)) < 1e-4
assert np.max(np.abs(np.array(backsweep) + 40.0)) < 1e-3
assert {"trailing_edge"} <= set(blade.surfaces)
