"""What a call or the command reaches on a cloud, and distances from what was built by a search of its own."""

import json
import resource
import subprocess
import sys
import time

import numpy as np
from matching_clouds import sides_of
from scipy.spatial import cKDTree

import bladewright as bw
from bladewright.errors import BladewrightError

GRID = (801, 401)
"""samples along and across a face from which nearest places are searched: with 121 across the other side of a long,
thin blade was nearer than the next sample, and a search from there ended on the rim, 6e-4 of the chord off"""
CLEAR = 10.0
"""distance of an outlier from what was built, of the noise, from which it counts"""
STEPS = 30
"""Gauss-Newton steps of a nearest place at most"""


def distances(points, faces):
    """Distances (n,) of points from the nearest of some curves or surfaces.

    From the nearest sample of each face a Gauss-Newton iteration in the parameters runs, held within the face.
    """
    best = np.full(len(points), np.inf)
    for face in faces:
        flat = not hasattr(face, "knots_u")
        knots = [face.knots] if flat else [face.knots_u, face.knots_v]
        axes = []
        for each, count in zip(knots, GRID, strict=False):
            breaks = np.unique(each)
            inner = np.linspace(0.0, 1.0, max(3, count // len(breaks)), endpoint=False)
            axes.append(np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * inner).ravel(), breaks[-1]))
        places = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")])
        samples = np.real(face(*axes) if flat else face.grid(*axes)).reshape(-1, points.shape[1])
        _, nearest = cKDTree(samples).query(points)
        at = places[:, nearest]
        low, high = (np.array([f(each) for each in axes])[:, None] for f in (np.min, np.max))
        found = samples[nearest] - points
        square = np.sum(found**2, axis=-1)
        active = np.arange(len(points))
        for _ in range(STEPS):
            miss = np.real(face(*at[:, active])) - points[active]
            slopes = [face.derivative(at[0, active])] if flat else []
            slopes = slopes or [face.derivative(*at[:, active], 1, 0), face.derivative(*at[:, active], 0, 1)]
            jacobian = np.stack([np.real(each) for each in slopes], axis=-1)
            gradient = np.einsum("ndk,nd->nk", jacobian, miss)
            # a parameter at its end that would leave the face is held
            held = ((at[:, active] <= low) & (gradient.T > 0.0)) | ((at[:, active] >= high) & (gradient.T < 0.0))
            jacobian = np.where(held.T[:, None, :], 0.0, jacobian)
            normal = np.einsum("ndk,ndl->nkl", jacobian, jacobian)
            size = np.einsum("nkk->n", normal)[:, None, None]
            normal = normal + (1e-12 * size + 1e-300) * np.eye(normal.shape[-1])
            step = -np.linalg.solve(normal, np.where(held.T, 0.0, gradient)[..., None])[..., 0].T
            # halved where it does not come nearer
            better = np.zeros(len(active), dtype=bool)
            for share in (1.0, 0.5, 0.25, 0.0625):
                trial = np.clip(at[:, active] + share * step, low, high)
                new = np.sum((np.real(face(*trial)) - points[active]) ** 2, axis=-1)
                good = ~better & (new < square[active] * (1.0 - 1e-14))
                at[:, active[good]], square[active[good]] = trial[:, good], new[good]
                better |= good
            active = active[better]
            if not len(active):
                break
        best = np.minimum(best, square)
    return np.sqrt(best)


def reached_by_call(cloud, options):
    """What `bladewright.fit` reaches."""
    start = time.process_time()
    try:
        found = bw.fit(cloud.points, **options)
    except BladewrightError as error:
        return {"seconds": time.process_time() - start, "status": "refused", "words": str(error)}
    seconds = time.process_time() - start
    record = {
        "seconds": seconds,
        "status": "passed" if found.passed else "not passed",
        "parameters": len(found.estimates),
        "rank": int(found.rank),
        "condition": float(found.condition),
        "noise": float(found.noise),
        "words": "; ".join([*found.failures, *found.notes]),
        **away(cloud, found.built, found.motion),
    }
    if cloud.outlier is not None:
        # one that was moved along the surface is none: at least ten times the noise is asked
        clear = cloud.outlier & (found.distances >= CLEAR * found.noise)
        record["planted"] = int(np.count_nonzero(clear))
        record["kept"] = int(np.count_nonzero(clear & found.inliers))
        record["good"] = int(np.count_nonzero(~cloud.outlier))
        record["dropped"] = int(np.count_nonzero(~cloud.outlier & ~found.inliers))
    return record


def away(cloud, built, motion=None):
    """Mean and largest distance of what measures a cloud from what was built."""
    points = cloud.points if cloud.others is None else cloud.others
    points = motion(points) if motion else points
    far = distances(points, sides_of(built))
    return {
        "chord": float(np.real(built.chord)),
        "mean": float(np.mean(far)),
        "max": float(np.max(far)),
        "of points": len(points),
    }


def reached_by_command(cloud, options, directory, path=None):
    """What `bladewright fit` reaches."""
    if path is None:
        path = directory / "cloud.csv"
        np.savetxt(path, cloud.points / cloud.unit, delimiter=",", fmt="%.15g")
        options = ("--unit", "mm", *options)
    design = directory / "found.toml"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "bladewright", "fit", str(path), *options, "-o", str(design), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    record = {"seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, "exit": done.returncode}
    report = json.loads(done.stdout) if done.stdout.strip() else {}
    if "deviation" not in report:
        return {**record, "status": "refused", "words": done.stderr.strip().replace("\n", " ")}
    motion = report.get("motion") or None
    if motion:
        rotation, translation = np.array(motion["rotation"]), np.array(motion["translation_m"])
        motion = lambda points: points @ rotation.T + translation  # noqa: E731
    return {
        **record,
        "status": "passed" if done.returncode == 0 else "not passed",
        "parameters": report["parameters"],
        "words": "; ".join([*report["failures"], *report["notes"], *report["cloud"]["notes"]]),
        **away(cloud, bw.read_design(design).build(), motion),
    }
