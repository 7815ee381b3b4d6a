"""An axial inducer: its blade angle at the tip, its wrap, and how far neighbours overlap."""

import numpy as np
from _common import example, export

blade = example("pump-inducer").build()
export(blade.design, blade)

_, y, z = np.moveaxis(blade.surfaces["upper"](np.linspace(0.0, 1.0, 401), np.ones(401)), -1, 0)
theta = np.unwrap(np.arctan2(y, z))
wrap = np.degrees(abs(theta[-1] - theta[0]))
solidity = blade.section(1.0).chord * blade.design.blade_count / (2.0 * np.pi * 0.06)

# the angle of the camber, read off the mean of both sides at the tip, against the law at the leading edge
section = blade.section(1.0)
angle = np.degrees(section.metal_angle_in)
print(f"wrap {wrap:.1f} deg and solidity {solidity:.2f} at the tip, blade angle {angle:.4f} deg at its leading edge")

assert abs(angle + 76.0) < 1e-3
assert 0.9 < solidity < 2.0
