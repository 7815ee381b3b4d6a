"""Which uncertainty a STEP file must state so that its trimming curves survive.

The ends of a blade lie off their walls by the error of the native sides between their interpolation sites, some
millionths of a millimetre. A reader that finds an edge further off a face than the file's uncertainty takes the
trimming curve to be wrong and replaces it by a cubic approximation of its own. Measured on the centrifugal impeller
with OpenCASCADE 7.9.3:

    uncertainty    largest gap after reading    largest edge tolerance    the same between sides
    1e-07 mm       1.1e-04 mm                   3.9e-06 mm                1e-07 mm
    1e-06 mm       1.1e-04 mm                   3.9e-06 mm                1e-07 mm
    2e-06 mm       5.5e-06 mm                   3.9e-06 mm                1e-07 mm
    1e-05 mm       5.5e-06 mm                   3.9e-06 mm                1e-07 mm

So the uncertainty is the largest gap of the solid; the edges between sides keep the smallest tolerance all the same.

    python design/cad_trimming_curves.py
"""

import re
import tempfile
from importlib.resources import files
from pathlib import Path

import bladewright as bw
from bladewright import cad
from bladewright.cad.closure import closure
from bladewright.cad.reading import read_cad_file


def main():
    blade = bw.read_design(Path(str(files("bladewright"))) / "examples" / "centrifugal-impeller.toml").build()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "impeller.step"
        cad.write(blade, path, samples=100)
        text = path.read_text("ascii")
        for uncertainty in ("1.E-07", "1.E-06", "2.E-06", "1.E-05"):
            path.write_text(
                re.sub(
                    r"(UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\()[^)]*", rf"\g<1>{uncertainty}", text, count=1
                ),
                "ascii",
            )
            opened = read_cad_file(path)
            joints = closure(opened.shape).edges
            sides = {k for k, name in opened.names.items() if name in {"upper", "lower"}}
            print(
                f"{float(uncertainty):.0e} mm  {max(joint.gap for joint in joints):.1e} mm  "
                f"{max(joint.tolerance for joint in joints):.1e} mm  "
                f"{max(joint.tolerance for joint in joints if set(joint.faces) <= sides):.0e} mm"
            )


if __name__ == "__main__":
    main()
