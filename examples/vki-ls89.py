"""The turbine guide vane VKI LS89 in its cascade: chord and throat as built, against the published ones."""

import numpy as np
from _common import example, export

blade = example("vki-ls89").build()
export(blade.design, blade)

u = np.linspace(0.0, 1.0, 2001)
upper, lower = (blade.surfaces[name](u, 0.5)[:, :2] for name in ("upper", "lower"))
pitch = 1e-3 * blade.design.pitch
gaps = np.linalg.norm(upper[:, None] - (lower + np.array([0.0, pitch]))[None], axis=-1)
throat = gaps.min()
# the published chord is the extent along the published stagger, -55 deg
along = np.array([np.cos(np.radians(-55.0)), np.sin(np.radians(-55.0))])
chord = np.ptp(np.concatenate([upper, lower]) @ along)
outlet = np.degrees(np.arccos(throat / pitch))
print(f"chord {1e3 * chord:.2f} mm, throat {1e3 * throat:.2f} mm: arccos(throat / pitch) is {outlet:.1f} deg")

# Arts, Lambert de Rouvroit and Rutherford 1990, VKI TN 174: chord 67.647 mm, throat 14.93 mm
assert abs(chord / 67.647e-3 - 1.0) < 0.005
assert abs(throat / 14.93e-3 - 1.0) < 0.01
