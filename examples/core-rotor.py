"""An axial compressor rotor on meanlines of given curvature: their turning, and how smooth their curvature is."""

import numpy as np
from _common import example, export

blade = example("core-rotor").build()
export(blade.design, blade)

section = blade.section(0.5)
(start, end), joints = section.meanline(np.array([0.0, 1.0]))[1], np.array([0.2, 0.5, 0.8])
turning = np.degrees(np.arctan(end) - np.arctan(start))

# the slope of v'' a little before and behind the places where its polynomials meet
step = 1e-5
ends = ((-2 * step, -step), (step, 2 * step))
rates = [np.diff([section.meanline(joints + at)[2] for at in both], axis=0) for both in ends]
jump = np.max(np.abs(rates[1] - rates[0]) / step) / np.max(np.abs(section.meanline(np.linspace(0, 1, 101))[2]))
print(f"turning {turning:.6f} deg at mid span; the slope of the curvature jumps by {jump:.1e} of it")

# from -53.875 to -36.5 deg: the laws of three control points at half span
assert abs(turning - 17.375) < 1e-6
# continuous: what is left is the third derivative over the step
assert jump < 1e-2
