"""How accurate OpenCASCADE's quadrature of areas and volumes is, and what it costs.

Without an error bound it takes a fixed number of Gauss points for each span of knots; with one it refines. Measured
with OpenCASCADE 7.9.3 on the fan rotor, relative to the native quadrature:

    bound    volume               area of the upper side
    none     +3.0e-06 in 0.07 s   +6.2e-07 in 0.04 s
    1e-06    -4.2e-10 in 0.10 s   +8.1e-10 in 0.03 s
    1e-09    +1.5e-09 in 0.21 s   +2.7e-13 in 0.10 s
    1e-10    +1.5e-09 in 0.25 s   +2.7e-13 in 0.12 s

The volumes truly differ by 1.5e-9: the native ends follow the sides, which lie that much off the wall. Without a bound
the measurement itself would miss the limit of 1e-6 on volumes. The round trip sets a bound of 1e-3 on volumes, which
for a passage with creased faces gives 4e-10 in a third of the time of 1e-7, and of 1e-7, 1e-9 and 1e-12 where that
disagrees by more than a fifth of a limit: at 1e-7 the centroids of 3 of 400 random designs
(random_designs.py, seeds 207, 294, 375) were 3e-6 to 1e-4 of the chord off, at 1e-10 5e-9 to 2e-7.

Where the normal reverses within a knot span no bound helps: the areas of whole sides of seeds 88, 166, 209, 239 and 348
stay 1e-9 to 7e-8 off with every bound. So the area of an untrimmed side is taken by quadrature on the poles that came
back, and only trimmed faces are left to the kernel.

    python design/cad_quadrature.py
"""

import time
from importlib.resources import files
from pathlib import Path

from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

import bladewright as bw
from bladewright.cad.deviation import NativeFace
from bladewright.cad.solids import occ_solid


def main():
    blade = bw.read_design(Path(str(files("bladewright"))) / "examples" / "fan-rotor.toml").build()
    made = occ_solid(blade)
    volume, area = float(blade.properties.volume) * 1e9, NativeFace(blade.surfaces["upper"]).area * 1e6
    for bound in ((), (1e-6,), (1e-9,), (1e-10,), (1e-11,)):
        results = []
        for function, shape, exact in (
            (BRepGProp.VolumeProperties_s, made.solid, volume),
            (BRepGProp.SurfaceProperties_s, made.faces["upper"], area),
        ):
            properties, start = GProp_GProps(), time.process_time()
            function(shape, properties, *bound)
            results.append(f"{properties.Mass() / exact - 1.0:+.1e} in {time.process_time() - start:.3f} s")
        print(f"{bound[0] if bound else 'none':<8}", *results, sep="   ")


if __name__ == "__main__":
    main()
