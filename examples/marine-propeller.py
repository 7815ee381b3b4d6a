"""A ship's propeller in one piece: pitch, expanded area, and the mass of the wheel, three times that of a sector."""

import numpy as np
from _common import example, export

import bladewright as bw

blade = example("marine-propeller").build()
wheel, sector = bw.wheel(blade), bw.sector(blade)
export(blade.design, wheel)

# the chord lines of the plain blade, along which pitch and chord are measured
stations = blade.report(np.linspace(0.0, 1.0, 41))
radius = 0.5 * (stations.leading_edge_r + stations.trailing_edge_r)
tip = radius[-1]
pitch = np.interp(0.7, radius / tip, 2.0 * np.pi * radius / np.tan(np.abs(stations.stagger)))
area = blade.design.blade_count * np.trapezoid(stations.chord, radius) / (np.pi * tip**2)
share = float(wheel.properties.volume / (blade.design.blade_count * sector.properties.volume) - 1.0)
print(
    f"pitch at 70 % of the radius {pitch / (2.0 * tip):.3f} diameters, expanded area ratio {area:.3f}, "
    f"{float(wheel.mass):.3f} kg, three sectors off by {abs(share):.0e}"
)

assert abs(pitch / (2.0 * tip) - 1.1) < 0.01
assert 0.45 < area < 0.6
assert abs(share) < 1e-9
