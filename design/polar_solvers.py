"""How far NeuralFoil is from XFOIL on three airfoils: run as `python design/polar_solvers.py`, half a minute."""

import numpy as np

import bladewright as bw

AIRFOILS = {
    "NACA 0018": bw.Naca4(thickness=0.18, camber=0.0, camber_position=0.4, trailing_edge="blunt"),
    "NACA 4412": bw.Naca4(thickness=0.12, camber=0.04, camber_position=0.4, trailing_edge="blunt"),
    "NACA 23012": bw.Naca5(thickness=0.12, trailing_edge="blunt"),
}


def main():
    alpha = np.arange(-5.0, 15.1, 1.0)
    print("| airfoil | Re | cl off, largest | cd off, median | largest |\n|---|---|---|---|---|")
    for name, profile in AIRFOILS.items():
        section = bw.ProfileSection(name=name, length_unit="m", chord=1.0, section=profile).build()
        for reynolds in (1e5, 5e5, 3.5e6):
            exact, quick = (bw.polar(section, reynolds, alpha, solver=each) for each in ("xfoil", "neuralfoil"))
            known = exact.converged
            lift = np.max(np.abs(quick.cl - exact.cl)[known])
            drag = np.abs(quick.cd / exact.cd - 1.0)[known]
            print(f"| {name} | {reynolds:g} | {lift:.3f} | {np.median(drag):.1%} | {np.max(drag):.1%} |")


if __name__ == "__main__":
    main()
