"""A vaned diffuser of circular arcs: the angles of its mean line, and by how much its channels open."""

import numpy as np
from _common import example, export

blade = example("vaned-diffuser").build()
export(blade.design, blade)

section = blade.section(0.5)
inlet, outlet = np.degrees([section.metal_angle_in, section.metal_angle_out])
(x, y, z), (x_out, y_out, z_out) = (blade.surfaces["upper"](at, 0.5) for at in (0.0, 1.0))
ratio = np.hypot(y_out, z_out) / np.hypot(y, z)
# channels between the vanes, from edge to edge; the walls are 16.27 and 17.16 mm apart there
opening = ratio * np.cos(np.radians(outlet)) / np.cos(np.radians(inlet)) * (17.16 / 16.27)
print(f"vane angles {inlet:.3f} and {outlet:.3f} deg at mid span, radius ratio {ratio:.4f}, area ratio {opening:.3f}")

# half of the turning of 14 deg to each side of the stagger
assert np.max(np.abs(np.array([inlet - 67.0, outlet - 53.0]))) < 1e-4
assert abs(ratio - 150.0 / 108.0) < 1e-6
assert 1.0 < opening < 3.0
