"""What the constants of `fitting/` decide: quick rows of matching with half and with twice of each.

    python design/matching_constants.py clouds model_selection/selection.py NEAR     rooms, files, names
    python design/matching_constants.py --all --record design/matching_constants.md

Of a number between a half and one, such as a confidence, the rest to one is halved and doubled. A constant is changed
in the source of its module when that is imported, so that all who bind it or compute with it have the other value. What
was reached is kept by the state of the sources in the temporary directory, so that a sweep goes on where it was ended.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import ast
import fnmatch
import importlib
import importlib.machinery
import json
import multiprocessing
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from matching import PLACE, state

import bladewright

ROOT = Path(bladewright.__file__).parent / "fitting"
SECTIONS = ("LS89-free", "Impulse-tolerance", "impulse-thin-free", "naca-blunt-noisy-unified")
BLADES = ("radial-diffuser-free",)
ROWS = {
    "clouds/walls.py": ("walls-compressor-stator", "walls-fan-rotor"),
    "clouds/cloud.py": ("aachen-annulus", "fan-two", "impeller-two", "ls89-suction"),
    "clouds": ("ls89-suction", "ls89-outliers", "compressor-outliers"),
    "registration.py": ("aligned-fan", "aligned-turbine", "prism-aachen"),
    "placing.py": ("held-section",),
    "models/designs.py": ("Aachen2D-suction-pressure",),
    "models/model.py": ("naca-blunt-exact-profile", "naca-blunt-noisy-profile"),
    "freeform": ("plain-curve", "plain-surface", "plain-profile"),
    "initial_guess": ("guess-Rotor67", "guess-compressor-stator", "guess-radial-stator"),
    "assessment": ("LS89-free", "ls89-half", "ls89-suction", "naca-blunt-noisy-unified", "naca-sharp-noisy-unified"),
    "families": ("Aachen2D-suction-pressure", "naca-sharp-noisy-profile"),
    "families/segmented.py": ("example-morphing-airfoil",),
    "families/unified.py": (*SECTIONS, *BLADES),
    "families/closed_blade.py": ("twisted-blunt-noisy-profile",),
    "families/blades.py": ("twisted-blunt-noisy-profile",),
    "families/first_blades.py": ("twisted-blunt-noisy-profile",),
    "families/sections.py": ("example-compressor-stator", "Aachen2D-suction-pressure"),
    "fit.py": ("LS89-free",),
    "model_selection/laws.py": ("twisted-blunt-noisy-profile", "example-morphing-airfoil"),
    "model_selection/structure.py": (*SECTIONS, *BLADES, "Aachen2D-suction-pressure"),
    "model_selection/structure_search.py": (*SECTIONS, *BLADES, "Aachen-tolerance"),
    "matching/blade_ends.py": ("Aachen-parameters", "radial-diffuser-free"),
    "": (*SECTIONS, *BLADES),
}
"""rows that are run for a file: of its own name, else of its room, else the last"""
MATTERS = 1.5
"""ratio of two figures from which a constant matters"""


def constants(root=ROOT):
    """File, name and value of every module constant that is a number or a tuple of numbers, by name and file."""
    for path in sorted(root.rglob("*.py")):
        for here in ast.parse(path.read_text()).body:
            if not isinstance(here, ast.Assign):
                continue
            try:
                value = ast.literal_eval(here.value)
            except ValueError:
                continue
            several = isinstance(here.targets[0], ast.Tuple)
            names = [each.id for each in (here.targets[0].elts if several else here.targets)]
            for name, each in zip(names, value if several else [value], strict=True):
                if name.isupper() and is_number(each):
                    yield str(path.relative_to(root)), name, each


def is_number(value):
    """Whether a value is a number, or a tuple or dictionary of numbers."""
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, tuple) else None
    if parts is not None:
        return bool(parts) and all(is_number(each) for each in parts)
    return isinstance(value, int | float) and not isinstance(value, bool)


def scaled(value, factor):
    """A constant's other value."""
    if isinstance(value, dict):
        return {key: scaled(each, factor) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(scaled(each, factor) for each in value)
    if isinstance(value, int):
        return round(value * factor)
    return float(f"{1.0 - (1.0 - value) * factor if 0.5 < value < 1.0 else value * factor:.6g}")


class Changed(importlib.machinery.SourceFileLoader):
    """Loads a module with another value of one of its constants."""

    def __init__(self, name, path, constant, value):
        super().__init__(name, path)
        self.constant, self.value = constant, value

    def get_code(self, fullname):
        """The code of the changed source, of which none is kept."""
        tree = ast.parse(self.get_data(self.get_filename(fullname)))
        for here in tree.body:
            if isinstance(here, ast.Assign):
                target = here.targets[0]
                several = isinstance(target, ast.Tuple)
                for i, each in enumerate(target.elts if several else here.targets):
                    if getattr(each, "id", "") == self.constant:
                        new = ast.parse(repr(self.value), mode="eval").body
                        if several:
                            here.value.elts[i] = new
                        else:
                            here.value = new
        return compile(ast.fix_missing_locations(tree), self.path, "exec")


class Finder:
    """Finds the module whose constant is changed."""

    def __init__(self, module, constant, value):
        self.module, self.constant, self.value = module, constant, value

    def find_spec(self, name, path, target=None):
        """Its specification, and of no other."""
        if name != self.module:
            return None
        found = importlib.machinery.PathFinder.find_spec(name, path, target)
        found.loader = Changed(name, found.origin, self.constant, self.value)
        return found


def reached(name):
    """What a row reaches: the largest distance (of the chord), parameters, status, and seconds of a processor."""
    since = time.process_time()
    kind, _, rest = name.partition("-")
    if kind in OWN:
        found = OWN[kind](rest)
    else:
        from matching_measures import away
        from matching_rows import ROWS as MATCHES

        import bladewright as bw

        row = MATCHES[name]
        with tempfile.TemporaryDirectory() as directory:
            cloud = row.cloud(Path(directory))
        since = time.process_time()
        options = {} if "aligned" in name or row.group == "brought" else row.options
        if row.group == "opened":
            import hold_outs

            cloud, options = hold_outs.told(cloud)
        try:
            fit = bw.fit(cloud.points, **options)
            far = away(cloud, fit.built, fit.motion)
            found = {
                "far": far["max"] / far["chord"],
                "parameters": len(fit.estimates),
                "status": "passed" if fit.passed else "not passed",
                "left out": len(fit.outliers),
                "unknown": len(fit.unidentified),
                "notes": len(fit.notes),
            }
        except bw.BladewrightError:
            found = {"far": None, "parameters": None, "status": "refused"}
    return {**found, "seconds": found.get("seconds", time.process_time() - since)}


def walls_told(machine):
    """Points of a hub and its fillet that are not told to be there, and those of sides that are, as a share of all."""
    import numpy as np
    from walls import of_machine

    from bladewright.fitting.clouds.walls import walls_of

    points, ends = of_machine(machine, 0.03, 1000, 1e-4)
    since = time.process_time()
    sides, fillet, hub = np.split(walls_of(points, None).kinds != "", ends)
    missed = np.count_nonzero(sides) + np.count_nonzero(~fillet) + np.count_nonzero(~hub)
    return {"far": missed / len(points), "status": "", "parameters": None, "seconds": time.process_time() - since}


def aligned(machine, *, started=True):
    """How far points with noise and outliers are from the place whence they were moved, of the blade's extent."""
    import matching_clouds as clouds
    import numpy as np

    from bladewright.fitting.registration import found_axes, registrations

    draw, design = np.random.default_rng(3), clouds.example(clouds.BROUGHT[machine])
    sides = design.build().sides
    true = clouds.scattered(sides, 5000, draw)
    moved = clouds.elsewhere(clouds.strewn(clouds.noisy(true, draw), draw) if started else true)
    since = time.process_time()
    motion = registrations(moved, design)[0][0] if started else found_axes(moved, arrangement="linear")[0]
    seconds = time.process_time() - since
    back = motion(clouds.elsewhere(true))
    extent = np.max(np.ptp(true, axis=0))
    if not started:
        # a prism may be shifted, and turned end for end: its span is compared
        back, true = np.ptp(back, axis=0)[2:], np.ptp(true, axis=0)[2:]
    return {"far": float(np.max(np.abs(back - true)) / extent), "status": "", "parameters": None, "seconds": seconds}


def plain(kind):
    """How far the truth of three plain fits is from them."""
    import freeform

    names = {"curve": "curve", "surface": "surface", "profile": "profile"}
    some = [each for each in freeform.CASES if names[kind] in each][:3]
    rows = [freeform.measured(each) for each in some]
    return {
        "far": 1e-6 * max(row["truth"] for row in rows),
        "parameters": sum(row["free"] for row in rows),
        "status": "passed" if all(row["passed"] for row in rows) else "not passed",
        "seconds": sum(row["seconds"] for row in rows),
    }


def guessed(name):
    """How far points are from the first blade that is found from them alone, in the mean, of its chord."""
    import matching_clouds as clouds
    import numpy as np
    from foreign_blades import SHAPES
    from matching_measures import away

    from bladewright.errors import BladewrightError
    from bladewright.fitting.families.kinds import DesignHeader
    from bladewright.fitting.initial_guess.blade import first_blades

    if name in SHAPES:
        cloud = clouds.Cloud(points=SHAPES[name]().points(np.random.default_rng(11)))
    else:
        cloud = clouds.measured(name) if name[0].isupper() else clouds.cloud_of(clouds.example(name))
    since = time.process_time()
    try:
        built = next(first_blades(cloud.points, DesignHeader(name="blade", length_unit="mm").known())).design.build()
    except BladewrightError:
        return {"far": None, "status": "refused", "parameters": None, "seconds": time.process_time() - since}
    seconds = time.process_time() - since
    far = away(cloud, built)
    return {"far": far["mean"] / far["chord"], "status": "", "parameters": None, "seconds": seconds}


def held(_):
    """How far a moved section is from one that is held in its place, begun with other angles and a thicker side."""
    import matching_clouds as clouds
    import numpy as np
    from matching_measures import away

    import bladewright as bw
    from bladewright.fitting.assessment.result import Motion

    truth = clouds.example("turbine-section")
    sides = truth.build().curves.values()
    moved = Motion(rotation=np.array([[-0.6, -0.8], [0.8, -0.6]]), translation=np.array([0.3, -0.1]))
    points = moved(np.concatenate([curve(np.linspace(0.0, 1.0, 150)) for curve in sides]))
    thicker = {f"thickness_upper[{i}]": 1.06 * each for i, each in enumerate(truth.thickness_upper)}
    angles = {"metal_angle_in": 1.05 * truth.metal_angle_in + 2.0, "metal_angle_out": 0.97 * truth.metal_angle_out}
    since = time.process_time()
    place = ("leading_edge_x", "leading_edge_y", "stagger")
    fit = bw.fit(points, truth.changed(thicker | angles), align=True, fixed=place)
    seconds = time.process_time() - since
    far = away(clouds.Cloud(points=points), fit.built, fit.motion)
    status = "passed" if fit.passed else "not passed"
    return {"far": far["max"] / far["chord"], "parameters": len(fit.estimates), "status": status, "seconds": seconds}


OWN = {
    "guess": guessed,
    "held": held,
    "walls": walls_told,
    "aligned": aligned,
    "prism": lambda machine: aligned(machine, started=False),
    "plain": plain,
}
"""rows of this script alone, by the first word of their names"""


def run(path, name, factor, rows, limit):
    """Print what rows reach with a changed constant, each in a process of its own that ends at the limit."""
    if name:
        value = {each: value for of, each, value in constants() if of == path}[name]
        module = "bladewright.fitting." + path.removesuffix(".py").replace("/", ".")
        assert module not in sys.modules
        sys.meta_path.insert(0, Finder(module, name, scaled(value, factor)))
    # what all rows import, once
    importlib.import_module("matching_rows")
    importlib.import_module("bladewright.fitting.fit")
    for row in rows:
        ours, theirs = multiprocessing.Pipe(duplex=False)

        def child(row=row, theirs=theirs):
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 2))
            theirs.send(reached(row))

        process = multiprocessing.get_context("fork").Process(target=child)
        process.start()
        theirs.close()
        try:
            found = ours.recv()
            process.join()
        except EOFError:
            process.join()
            status = "killed" if process.exitcode < 0 else "broke"
            found = {"far": None, "parameters": None, "status": status, "seconds": limit}
        print(json.dumps({"row": row, **found}), flush=True)


def rows_of(path, only=("*",)):
    """The rows that are run for a file, of those with some names or patterns."""
    rows = ROWS.get(path) or ROWS.get(path.partition("/")[0]) or ROWS[""]
    return [row for row in rows if any(fnmatch.fnmatch(row, each) for each in only)]


def swept(chosen, limit, only):
    """Records of constants with half and twice their values, and of none changed."""
    PLACE.mkdir(exist_ok=True)
    own = state()
    kept = PLACE / f"constants-{own}.jsonl"
    known = {}
    for text in kept.read_text().splitlines() if kept.exists() else []:
        record = json.loads(text)
        known[record["path"], record["name"], record["factor"], record["row"]] = record
    tasks = [("", "", 1.0, row) for row in dict.fromkeys(row for path, *_ in chosen for row in rows_of(path, only))]
    tasks += [
        (path, name, factor, row) for path, name, _ in chosen for factor in (0.5, 2.0) for row in rows_of(path, only)
    ]
    groups = {}
    for task in tasks:
        if task not in known:
            groups.setdefault(task[:3], []).append(task[3])
    for (path, name, factor), rows in groups.items():
        command = [sys.executable, __file__, "--run", path, name, str(factor), *rows, "--limit", str(limit)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        if len(found) < len(rows):
            # the changed constant breaks an import, or the script
            words = (done.stderr.strip().splitlines() or [""])[-1]
            print(f"{path} {name} {factor:g}: {words}", file=sys.stderr)
            found += [
                {"row": row, "far": None, "parameters": None, "status": "broke", "seconds": 0.0}
                for row in rows[len(found) :]
            ]
        with kept.open("a") as file:
            for each in found:
                record = {"path": path, "name": name, "factor": factor, **each}
                file.write(json.dumps(record) + "\n")
                known[path, name, factor, each["row"]] = record
        if name:
            value = next(value for of, each, value in chosen if (of, each) == (path, name))
            print(line(path, name, value, factor, known), flush=True)
    return own, known


def ratios(record, before):
    """By how much the figures of a record are above or below those of another, each at least 1."""
    pairs = [(record[key], before[key]) for key in ("far", "parameters", "seconds")]
    # what is nearer than that is met exactly
    floors = (1e-6, 1.0, 0.5)
    return [
        1.0 if a is None or b is None else max(max(a, floor) / max(b, floor), max(b, floor) / max(a, floor))
        for (a, b), floor in zip(pairs, floors, strict=True)
    ]


def matters(path, name, known, factors=(0.5, 2.0)):
    """Whether a constant changes any figure of a row by more than 1.5, or its status."""
    found = []
    for factor in factors:
        for row in rows_of(path):
            if (path, name, factor, row) not in known:
                continue
            record, before = known[path, name, factor, row], known["", "", 1.0, row]
            found.append(record["status"] != before["status"] or max(ratios(record, before)) > MATTERS)
    return any(found)


def line(path, name, value, factor, known):
    """A line of the table: what changed by more than a twentieth, of each row."""
    cells = []
    for row in rows_of(path):
        if (path, name, factor, row) not in known:
            continue
        record, before = known[path, name, factor, row], known["", "", 1.0, row]
        change = ratios(record, before)
        words = [record["status"]] if record["status"] != before["status"] else []
        words += [f"{record['far']:.1e} ({before['far']:.1e})"] if change[0] > 1.05 else []
        words += [f"{record['parameters']} parameters ({before['parameters']})"] if change[1] > 1.05 else []
        words += [f"{record['seconds']:.1f} s ({before['seconds']:.1f})"] if change[2] > MATTERS else []
        cells += [f"{row}: {', '.join(words)}"] if words else []
    mark = "**" if matters(path, name, known, (factor,)) else ""
    shown = f"{scaled(value, factor)}".replace("|", "/")
    return f"| `{path}` {mark}`{name}`{mark} = {value} | {shown} | {'; '.join(cells) or '-'} |"


STILL = """\
## Without effect

Half and twice of these change no figure of the rows by more than a twentieth:
"""
HEAD = """\
# Constants of matching

`python design/matching_constants.py`, sources {state}, {date}: rows of `matching.py` with half and with twice of one
constant; of a confidence or share between a half and one, the rest to one. A row is named where its largest distance
(of the chord) or its number of parameters changes by more than a twentieth, its seconds by half, or its status; before
in brackets. Bold, and first: by more than {matters} times. For most only rows in the plane are run (LS89 with nothing
asked, Impulse with a tolerance, a noisy blunt profile), so that what blades in space alone need seems to have no
effect. Rows of this script alone: `walls-`, share of a hub's, a fillet's and the sides' points that are taken for
others (`walls.py`); `aligned-` and `prism-`, distance from their place of points that were moved; `plain-`, of the
truth from plain fits (`freeform.py`); `guess-`, mean distance of the first blade; `held-`, of a moved section held in
its place.

| constant | value | what changes |
|---|---|---|
"""


BY_HAND = "\n## On rows that reach them"
"""what follows in the file is not made by this script, and stays"""


def write_table(path, chosen, own, known):
    """Write what was reached: a table, constants that matter first, and the names of those without effect."""
    rows, still = [], {}
    for of, name, value in chosen:
        ran = [(f, row) for f in (0.5, 2.0) for row in rows_of(of) if (of, name, f, row) in known]
        if not ran:
            continue
        found = [line(of, name, value, f, known) for f in (0.5, 2.0)]
        if all(each.endswith("| - |") for each in found):
            still.setdefault(of, []).append(f"`{name}` {value}")
        else:
            rows += [(not matters(of, name, known), each) for each in found if not each.endswith("| - |")]
    head = HEAD.format(state=own, date=time.strftime("%Y-%m-%d"), matters=MATTERS)
    lines = [each for _, each in sorted(rows, key=lambda each: each[0])]
    quiet = [f"* {of}: {', '.join(names)}" for of, names in still.items()]
    _, mark, by_hand = (path.read_text(encoding="utf-8") if path.exists() else "").partition(BY_HAND)
    made = head + "\n".join(lines) + "\n\n" + STILL + "\n" + "\n".join(quiet) + "\n"
    path.write_text(made + mark + by_hand, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="rooms, files or names of constants")
    parser.add_argument("--all", action="store_true", help="every constant")
    parser.add_argument("--list", action="store_true", help="print the constants and their values")
    parser.add_argument("--rows", nargs="+", default=["*"], help="names or patterns of the rows that are run")
    parser.add_argument("--limit", type=float, default=60.0, help="processor seconds of a row")
    parser.add_argument("--record", type=Path, help="write the table to this file")
    parser.add_argument("--run", nargs="+", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        path, name, factor, *rows = given.run
        return run(path, name, float(factor), rows, given.limit)
    chosen = [
        each
        for each in constants()
        if given.all or {each[0], each[0].partition("/")[0], each[1]} & {each.removesuffix("/") for each in given.names}
    ]
    if given.list:
        print("\n".join(f"{path} {name} = {value}" for path, name, value in chosen))
        return 0
    own, known = swept(chosen, given.limit, given.rows)
    if given.record:
        write_table(given.record, chosen, own, known)
    return 0


if __name__ == "__main__":
    sys.exit(main())
