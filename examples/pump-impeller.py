"""A pump's shrouded impeller, trimmed: the trim on the built surfaces, wrap, and what fillets and trim weigh."""

import numpy as np
from _common import example, export

design = example("pump-impeller")
blade = design.build()
export(blade.design, blade)

face = blade.surfaces["trailing_edge"]
u, v = face.interior_points(2000)
off = 1e3 * np.max(np.abs(np.hypot(*face(u, v)[:, 1:].T) - 0.095))
full = design.changed("cut", None).build()
wrap = np.degrees(float(np.mean(blade.report([0.5]).wrap)))
left = float(blade.properties.volume / full.properties.volume)
print(f"trimmed at a radius of 95 mm within {off:.0e} mm, wraps {wrap:.1f} deg, {left:.3f} of the blade is left")

assert off < 1e-9
# what the trim takes off a blade of about constant thickness: its share of the length
assert 0.85 < left < 0.95
