"""A cantilevered compressor stator: how far its free end stands off the hub, and its diffusion factor."""

import numpy as np
from _common import example, export

blade = example("compressor-stator").build()
export(blade.design, blade)

# the free end's outline in the meridional plane, against the straight line of the hub
outline = np.concatenate([blade.surfaces[side](np.linspace(0.0, 1.0, 201), 0.0) for side in ("upper", "lower")])
points = np.column_stack([outline[:, 0], np.hypot(outline[:, 1], outline[:, 2])])
start, end = 1e-3 * np.array([blade.design.channel.leading_edge[0], blade.design.channel.trailing_edge[0]])
along = (end - start) / np.linalg.norm(end - start)
gap = 1e3 * ((points - start) @ np.array([-along[1], along[0]]))

section = blade.section(0.5)
_, y, z = blade.surfaces["upper"](0.0, 0.5)
solidity = section.chord * blade.design.blade_count / (2.0 * np.pi * np.hypot(y, z))
inlet, outlet = np.arctan(0.95), np.radians(10.0)
turning = np.cos(inlet) * (np.tan(inlet) - np.tan(outlet)) / (2.0 * solidity)
diffusion = 1.0 - np.cos(inlet) / np.cos(outlet) + turning
print(f"free end {gap.min():.6f} to {gap.max():.6f} mm off the hub, diffusion factor {diffusion:.3f} at mid span")

assert np.max(np.abs(gap - 0.5)) < 1e-5
# Lieblein 1953: losses rise from 0.6 on; half of that would be a stator of too many vanes
assert 0.4 < diffusion < 0.55
