"""A radial-inflow turbine rotor, fitted to a cloud: its inlet lies on a cylinder and its blades enter radially."""

import numpy as np
from _common import example, export

blade = example("radial-turbine").build()
export(blade.design, blade)

v = np.linspace(0.0, 1.0, 21)
_, y, z = np.moveaxis(blade.surfaces["upper"](0.0, v), -1, 0)
radius = np.hypot(y, z)
# at its very edge a side runs across the camber; with the inlet radial, the camber lies in the plane x = const
_, dy, dz = np.moveaxis(blade.surfaces["upper"].derivative(0.0, v, du=1), -1, 0)
inward, around = -(y * dy + z * dz) / radius, (z * dy - y * dz) / radius
inlet = np.degrees(np.arctan2(-inward, around))
print(f"inlet radius {1e3 * radius.mean():.2f} mm, blade angle {inlet.min():.2f} to {inlet.max():.2f} deg")

# a rotor at this speed takes its load in pull alone: radial fibres at the tip, here within 2 deg
assert np.ptp(radius) < 1e-5
assert np.max(np.abs(inlet)) < 2.0
