"""The nozzle ring of a radial-inflow turbine: its throat, and the angle that it turns the flow to."""

import numpy as np
from _common import example, export

from bladewright.blade.native.throat import throat

blade = example("inflow-nozzle").build()
export(blade.design, blade)

narrowest = throat(blade)
width, count = narrowest.width.mean(), blade.design.blade_count
# of a free vortex of incompressible flow through the throat: the circumference at the trailing edge against the throats
angle = np.degrees(np.arccos(width * count / (2.0 * np.pi * 0.066)))
print(f"{count} throats of {1e3 * width:.3f} mm, {1e6 * count * narrowest.area:.1f} mm2 in all; {angle:.2f} deg")

# parallel walls and equal sections: the same throat all along the span, as high as the channel
assert np.ptp(narrowest.width) < 1e-9
assert abs(narrowest.area / (width * 0.014) - 1.0) < 1e-6
assert 50.0 < angle < 75.0
