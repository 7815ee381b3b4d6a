"""A compressor stator by suction and pressure side: its diffusion factor, and how it keeps the given stream surface."""

import numpy as np
from _common import example, export

blade = example("booster-stator").build()
export(blade.design, blade)

section = next(each for each in blade.sections if each.span == 0.5)
inlet, outlet = section.metal_angle_in, section.metal_angle_out
_, y, z = blade.surfaces["upper"](0.0, 0.5)
solidity = section.chord * blade.design.blade_count / (2.0 * np.pi * np.hypot(y, z))
turning = np.cos(inlet) * (np.tan(inlet) - np.tan(outlet)) / (2.0 * solidity)
diffusion = 1.0 - np.cos(inlet) / np.cos(outlet) + turning

# how far the blade at half span lies off the stream surface that was given there
u = np.linspace(0.0, 1.0, 201)
x, y, z = np.moveaxis(blade.surfaces["upper"](u, np.full_like(u, 0.5)), -1, 0)
given = np.array([[point.x, point.r] for point in blade.design.flow_path.stream_surfaces[0].points]) * 1e-3
# the spline through those points is nearly straight: between them a parabola is as good
off = np.hypot(y, z) - np.polyval(np.polyfit(given[:, 0], given[:, 1], 3), x)
print(
    f"diffusion factor {diffusion:.3f} at mid span, solidity {solidity:.3f}, off by {1e6 * np.max(np.abs(off)):.2f} um"
)

# Lieblein 1953: losses rise from 0.6 on
assert 0.35 < diffusion < 0.55
assert np.max(np.abs(off)) < 5e-6
