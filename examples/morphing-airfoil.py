"""NACA 23012 with a drooped nose and a lowered tail: how far its edges move while the central box stays."""

import numpy as np
from _common import example, export

import bladewright as bw

design = example("morphing-airfoil")
export(design, bw.prismatic(design).build())

morphed = design.build()
plain = design.changed("section.morph", bw.Morph()).build()
s = np.linspace(*morphed.outline.cuts, 201)
box = max(np.max(np.abs(morphed.curves[name](s) - plain.curves[name](s))) for name in ("upper", "lower"))
nose, tail = 1e3 * (plain.camber(np.array([0.0, 1.0])) - morphed.camber(np.array([0.0, 1.0])))[:, 1]
print(f"the nose droops by {nose:.2f} mm, the tail by {tail:.2f} mm; chord {1e3 * morphed.chord:.2f} mm for 245")

# the tail is 0.3 chords long and turns by 15 deg; both are native curves within 1e-8 of the chord
assert abs(tail - 0.3 * design.chord * np.sin(np.radians(15.0))) < 0.3
assert box < 3e-8 * 0.245
