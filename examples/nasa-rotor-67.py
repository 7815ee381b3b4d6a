"""NASA Rotor 67, fitted to a cloud: solidity at hub and tip, against the published figures."""

import numpy as np
from _common import example, export

blade = example("nasa-rotor-67").build()
export(blade.design, blade)

_, y, z = np.moveaxis(blade.surfaces["upper"](np.array([[0.0], [1.0]]), np.array([0.0, 1.0])), -1, 0)
pitch = 2.0 * np.pi * np.hypot(y, z).mean(axis=0) / blade.design.blade_count
solidity = np.array([blade.section(v).chord for v in (0.0, 1.0)]) / pitch
print(f"solidity {solidity[0]:.3f} at the hub, {solidity[1]:.3f} at the tip")

# Strazisar et al., NASA TP 2879, 1989: 3.11 at the hub and 1.29 at the tip
assert abs(solidity[0] / 3.11 - 1.0) < 0.01
assert abs(solidity[1] / 1.29 - 1.0) < 0.01
