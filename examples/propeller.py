"""A propeller blade: pitch at 70 % of the radius and activity factor, measured on the built surfaces."""

import numpy as np
from _common import example, export

blade = example("propeller").build()
export(blade.design, blade)

upper = blade.surfaces["upper"]
v = np.linspace(0.0, 1.0, 201)
leading, trailing = upper(0.0, v), upper(1.0, v)
radius = np.hypot(leading[:, 1], leading[:, 2])
turn = np.arctan2(trailing[:, 1], trailing[:, 2]) - np.arctan2(leading[:, 1], leading[:, 2])
along = trailing[:, 0] - leading[:, 0]
chord = np.hypot(along, radius * turn)

tip = radius[-1]
pitch = np.interp(0.7, radius / tip, -2.0 * np.pi * along / turn)
share = radius / tip
activity = 1e5 / 16.0 * np.trapezoid(chord / (2.0 * tip) * share**3, share)
print(f"pitch at 70 % of the radius {pitch:.3f} m, {pitch / (2.0 * tip):.3f} diameters; activity factor {activity:.1f}")

# advance per turn is V / n = 66 / 40 = 1.65 m; the blade's pitch lies above it by the angle of attack, 3.4 deg there
advance = 66.0 / 40.0
attack = np.degrees(np.arctan(pitch / (1.4 * np.pi * tip)) - np.arctan(advance / (1.4 * np.pi * tip)))
assert abs(attack - 3.4) < 0.3
# light aircraft propellers lie at 80 to 110
assert 80.0 < activity < 110.0
