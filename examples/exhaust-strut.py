"""A wedge-shaped strut: the flow area that a row of them blocks, and the thickness of their back faces."""

import numpy as np
from _common import example, export

blade = example("exhaust-strut").build()
export(blade.design, blade)

section = blade.section(0.0)
upper, lower = (np.real(section.curves[side](np.linspace(0.0, 1.0, 4001))) for side in ("upper", "lower"))
# across the chord line: a wedge is thickest at its back
across = np.array([-np.sin(section.stagger), np.cos(section.stagger)])
thickness = float(section.scale(upper[-1:, 0])[0] * (np.max(upper @ across) - np.min(lower @ across)))
_, y, z = blade.surfaces["upper"](1.0, 0.0)
blocked = blade.design.blade_count * thickness / (2.0 * np.pi * np.hypot(y, z) * np.cos(section.stagger))
print(f"{1e3 * thickness:.2f} mm thick at the hub, where {blade.design.blade_count} struts block {100 * blocked:.1f} %")

# a circle of 3 % of the chord, flanks 8 deg apart, corners of 2 %
asked = 2.0 * (0.030 + np.sin(np.radians(4.0)) * (1.0 - 0.030 - 0.02)) / np.cos(np.radians(4.0))
assert 0.1 < blocked < 0.5
assert abs(thickness / (section.chord * asked) - 1.0) < 0.1
