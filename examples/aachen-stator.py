"""The first vane of the Aachen turbine in its annulus: chord and pitch as built, against the published ones."""

import numpy as np
from _common import example, export

blade = example("aachen-stator").build()
export(blade.design, blade)

section = blade.section(0.5)
_, y, z = blade.surfaces["upper"](0.0, 0.5)
pitch = 2.0 * np.pi * np.hypot(y, z) / blade.design.blade_count
print(f"chord {1e3 * section.chord:.2f} mm, pitch {1e3 * pitch:.2f} mm at mid span")

# Walraevens and Gallus 1997: chord 62 mm, pitch 47.6 mm at mid span; the cloud has the rig's diameters for radii
assert abs(section.chord / 62e-3 - 1.0) < 0.01
assert abs(pitch / 2.0 / 47.6e-3 - 1.0) < 0.01
