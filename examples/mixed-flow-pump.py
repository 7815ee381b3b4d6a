"""A mixed-flow pump impeller: wrap angle of the blade, measured on the built surfaces."""

import numpy as np
from _common import example, export

blade = example("mixed-flow-pump").build()
export(blade.design, blade)

edges = blade.surfaces["upper"](np.linspace(0.0, 1.0, 201)[:, None], np.array([0.0, 1.0]))
theta = np.unwrap(np.arctan2(edges[..., 1], edges[..., 2]), axis=0)
wrap = np.degrees(theta[-1] - theta[0])
print(f"the blade wraps {wrap[0]:.1f} deg at the hub and {wrap[1]:.1f} deg at the shroud")

# against the rotation, and over more than a pitch of 72 deg, so that the blades overlap; the aim was 100 to 120 deg
assert np.all((wrap > -120.0) & (wrap < -100.0))
