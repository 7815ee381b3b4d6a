"""A turbine section and the prismatic blade that it becomes: its throat and the outlet angle that it gives."""

import numpy as np
from _common import example, export

import bladewright as bw

design = example("turbine-section")
export(design, bw.prismatic(design).build())

section = design.build()
u = np.linspace(0.0, 1.0, 2001)
suction, pressure = (np.real(section.curves[name](u)) for name in ("upper", "lower"))
pitch = 1e-3 * design.pitch
gaps = np.linalg.norm(suction[:, None] - (pressure + np.array([0.0, pitch]))[None], axis=-1)
throat = gaps.min()
outlet = np.degrees(np.arccos(throat / pitch))
print(f"throat {1e3 * throat:.3f} mm, throat / pitch {throat / pitch:.4f}: the gas leaves at {outlet:.2f} deg")

# the throat is normal to the flow, so arccos(throat / pitch) is the outlet angle: the metal angle, within 1 deg
assert abs(outlet + design.metal_angle_out) < 1.0
