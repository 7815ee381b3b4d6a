"""An inlet guide vane of 65-series profiles: its thickness, and where it is thickest."""

import numpy as np
from _common import example, export

blade = example("inlet-guide-vane").build()
export(blade.design, blade)

section = blade.section(0.0)
thickest, place = section.maximum_thickness
share = thickest / float(np.real(section.chord))
print(f"thickness {100 * share:.3f} % of the chord at the hub, largest at {100 * place:.1f} % along the camber")

# 65-(09)09: 9 % of the chord, along which radii change by nothing at this hub
assert abs(share - 0.09) < 1e-4
