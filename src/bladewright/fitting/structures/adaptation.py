"""The structure of a design as its cloud asks for it: control points are added until an aim is reached."""

from dataclasses import replace

import numpy as np

from bladewright.designs import Design
from bladewright.errors import DesignError
from bladewright.fitting.clouds.rounding import rounded
from bladewright.fitting.clouds.thinning import drawn
from bladewright.fitting.freedom import corner_radii
from bladewright.fitting.matching.chain import own_walls
from bladewright.fitting.matching.descent import SLIGHT
from bladewright.fitting.matching.search import ROUGH, ROUNDS, Found, Task, searched
from bladewright.fitting.structures.aim import NOISY, Aim, short_of
from bladewright.fitting.structures.choosing import chosen_match, compact_match
from bladewright.fitting.structures.given import FIRST, QUICK, QUIET, leaner, misses, structured
from bladewright.fitting.structures.growing import grown
from bladewright.fitting.structures.growth import FEWEST
from bladewright.fitting.structures.identification import identified
from bladewright.fitting.structures.opening import opened
from bladewright.fitting.structures.pressing import little, pressed
from bladewright.fitting.structures.reshaping import reshaped
from bladewright.fitting.structures.structure import Structure, structure_of
from bladewright.fitting.structures.tolerance import kept
from bladewright.section.unified import UnifiedSection

SHAKEN = 0.03
"""noise from which a match of a section is tried once more, of the chord"""
FINEST = 1e-6
"""misfit at which it is not, of that"""
FINE = 1e-3
"""part of the cost that a step of the last search must promise, where the cloud is not taken for exact"""
FEW, MANY = {2: 2500, 3: 1000}, 12_000
"""points of a quick, by dimension, and of a thorough search"""
SEVERAL = 2500
"""points with which a blade grows towards a tolerance, which asks for every row of them"""
FURTHER = 30.0
"""by how much noses are held further from what is refused, where a design is"""
COMPACT = 0.5
"""root mean square distance, of a tolerance, with which a blade begins to grow towards it"""
NEARLY = (0.3, 0.02)
"""root mean square distance, of a tolerance, and part of the points beyond it with which no more is added at first"""
WORTH_GROWING = 0.7
"""misfit, of that before, with which a match that had settled goes on growing"""
GROWTHS = 40
"""times that more is added at most"""
IN_ROWS = 1e-3
"""spread of the points at an end below which they stand in a row on the wall, of the chord"""
STANDING = "the radii of the channel's corners are read off the points at hub and shroud, held, and not counted"


def adapted(task: Task, first: Design, aim: Aim, *, base: Structure | None, guessed: bool) -> tuple[Found, str]:
    """The match, and why it ends where no aim is met.

    `first` is a first design, a guess or a start; `base` the structure from which to grow, where it is not that of
    `first`.
    """
    few = task.part(drawn(len(task.points), FEW[task.points.shape[1]]))
    several, many = (task.part(drawn(len(task.points), most)) for most in (SEVERAL, MANY))
    noise = FIRST if guessed else None
    if aim.structured and aim.tolerance is None:
        return structured(few, many, first, base, guessed=guessed), ""
    found = searched(few, first, noise=noise, rounds=2 * QUICK if base is None else QUICK, slight=ROUGH)
    exact = guessed and aim.open and not rounded(task.points)
    if exact and isinstance(first, UnifiedSection) and misses(found, QUIET):
        known = identified(few, first)
        if known is not None:
            return (known if known.interrupted else searched(many, known.design)), ""
    standing, everything = aim.parameters is not None and _in_rows(found), few
    if standing:
        few, many = _on_walls(few), _on_walls(many)
    found, reason = _structured_for(few, several, found, aim, base, guessed=guessed)
    if standing:
        reason = STANDING
        found = found if found.interrupted else searched(everything, found.design, rounds=1, slight=ROUGH)
    if found.interrupted:
        return found, reason
    rounds = ROUNDS
    if task.points.shape[1] == 3 and not aim.open:
        # growth to a tolerance has weighed points by their distances, and what follows does so too
        rounds = QUICK if aim.tolerance is None else 0
    if task.points.shape[1] == 3 and not aim.open and _refused(found):
        many = replace(many, slack=FURTHER * many.slack)
    found = searched(many, found.design, rounds=rounds, slight=SLIGHT if aim.open else FINE)
    if guessed and task.points.shape[1] == 2:
        found = _shaken(many, found)
    elif guessed and aim.open:
        found = _grown_on(several, many, found, aim)
    if aim.tolerance is not None and (not reason or found.scatter.shared >= NOISY):
        found = kept(many, found, aim, aim.tolerance)
        reason = reason if found.maximum > aim.tolerance else ""
    return found, reason


def _structured_for(
    task: Task, several: Task, found: Found, aim: Aim, base: Structure | None, *, guessed: bool
) -> tuple[Found, str]:
    """A match with as many control points as the aim asks for, as forecasts or growth lead there, or why not."""
    solid = guessed and task.points.shape[1] == 3 and own_walls(found.design) and not found.interrupted
    if solid and aim.parameters is not None:
        foreseen = chosen_match(task, found, aim.parameters)
        if foreseen is not None:
            return foreseen, ""
    if solid and aim.tolerance is not None:
        if found.rms * found.model.chord > aim.tolerance:
            found = chosen_match(task, found, len(found.problem.paths)) or found
        if found.rms * found.model.chord < COMPACT * aim.tolerance:
            found = compact_match(task, found, COMPACT * aim.tolerance) or found
        if not found.interrupted:
            task = several
            measured = searched(task, found.design, rounds=0)
            found = replace(measured, evaluations=measured.evaluations + found.evaluations)
    elif solid:
        # forecasts are linear: they tell of more the nearer a match is
        found = searched(task, found.design, noise=found.rms, slight=ROUGH)
        found = chosen_match(task, found, len(found.problem.paths)) or found
    elif base is not None and not found.interrupted and _roomy(found, aim):
        found = leaner(task, found, base)
    return _enough(task, found, aim)


def _enough(task: Task, found: Found, aim: Aim) -> tuple[Found, str]:
    """A match with as many control points as the aim asks for, or why there are no more."""
    reason = ""
    for _ in range(GROWTHS):
        if found.interrupted:
            return found, ""
        short, reason = short_of(found, aim, task)
        if not short or _nearly(found, aim):
            break
        before = found.rms
        found, grew = grown(task, found, aim)
        if not grew:
            found, grew = pressed(task, found, aim)
        if not grew or little(task, found, aim, before):
            break
    if aim.parameters is not None and task.points.shape[1] == 2:
        found = _exchanged(task, found)
    return found, reason


def _grown_on(several: Task, many: Task, found: Found, aim: Aim) -> Found:
    """A match that grows on where it has settled at a misfit that is no noise: forecasts are truer the nearer it is."""
    while misses(found):
        more, grew = grown(several, found, aim)
        if not grew:
            break
        fresh = more if more.interrupted else searched(many, more.design)
        if fresh.misfit > WORTH_GROWING * found.misfit:
            return replace(found, interrupted=fresh.interrupted)
        found = fresh
    return found


def _nearly(found: Found, aim: Aim) -> bool:
    """Whether all but a few points of a blade keep a tolerance: weighing those more may do."""
    on = found.state.feet
    if aim.tolerance is None or on.points.shape[1] == 2 or found.rms * found.model.chord > NEARLY[0] * aim.tolerance:
        return False
    return bool(np.mean(on.distances[found.rows] > aim.tolerance) < NEARLY[1])


def _exchanged(task: Task, found: Found) -> Found:
    """The best of the ways to share the control points of a section's thickness between its sides."""
    for way in (1, -1):
        while not found.interrupted:
            structure = structure_of(found.design)
            upper, lower = structure.chordwise[0] + way, structure.chordwise[1] - way
            if min(upper, lower) < FEWEST:
                break
            design = opened(reshaped(found.design, replace(structure, chordwise=(upper, lower))))
            other = searched(task, design, rounds=QUICK + 1, noise=found.rms, slight=ROUGH)
            evaluations = found.evaluations + other.evaluations
            if not (other.rms < found.rms or other.interrupted):
                found = replace(found, evaluations=evaluations)
                break
            found = replace(other, evaluations=evaluations)
    return found


def _shaken(task: Task, found: Found) -> Found:
    """The better of a match and of one that starts from it as if it knew little: a nose may lie in a wrong place."""
    if found.interrupted or found.rms < SHAKEN * FINEST:
        return found
    other = searched(task, found.design, noise=SHAKEN)
    # of all points: a match that takes more of them for outliers is no nearer
    nearer = other if other.off < found.off and other.rms < found.rms else found
    evaluations = found.evaluations + other.evaluations
    return replace(nearer, evaluations=evaluations, interrupted=other.interrupted)


def _refused(found: Found) -> bool:
    """Whether a design that searches pass is refused when it is built: its noses must be held further off."""
    try:
        found.design.build()
    except DesignError:
        return True
    return False


def _in_rows(found: Found) -> bool:
    """Whether the cloud shows by rows of points where hub and shroud are."""
    walls = found.ends.walls
    return len(walls) == 2 and all(wall.spread < IN_ROWS * found.model.chord for wall in walls.values())


def _on_walls(task: Task) -> Task:
    """A task that holds the radii of the channel's corners."""
    return replace(task, free=lambda design: tuple(p for p in task.free(design) if p not in corner_radii(design)))


def _roomy(found: Found, aim: Aim) -> bool:
    """Whether a first design has more parameters than its cloud may need, or than are asked for."""
    if aim.tolerance is not None and found.rms * found.model.chord > aim.tolerance:
        return False
    return aim.parameters is None or len(found.problem.paths) > aim.parameters
