"""What ParaBlade evaluates for a configuration, written anew from its recipe as a witness: one point at a time."""

import math

import numpy as np


def entries(text):
    found = {}
    for line in text.splitlines():
        key, sign, rest = line.partition("=")
        if sign and key[:1] not in "#% ":
            found[key.strip()] = [word for word in rest.replace(",", " ").split() if word]
    return found


def spline(points, t):
    """de Boor's algorithm on clamped uniform knots, degree min(n - 1, 3)."""
    points = [np.asarray(point, dtype=float) for point in points]
    degree = min(len(points) - 1, 3)
    spans = len(points) - degree
    knots = [0.0] * degree + [i / spans for i in range(spans + 1)] + [1.0] * degree
    span = degree + min(int(t * spans + 1e-12), spans - 1)
    work = [points[span - degree + j] for j in range(degree + 1)]
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            low, high = knots[span - degree + j], knots[span + 1 + j - level]
            share = (t - low) / (high - low)
            work[j] = (1.0 - share) * work[j - 1] + share * work[j]
    return work[degree]


class Witness:
    def __init__(self, text):
        words = entries(text)
        self.laws = {key: [float(word) for word in value] for key, value in words.items() if not key[0].isupper()}
        self.annular = words["CASCADE_TYPE"] == ["ANNULAR"]
        self.two = float(words["NDIM"][0]) == 2.0

    def law(self, key, v):
        return float(spline(self.laws[key], v))

    def section(self, v):
        """Control points of the lower and the upper side."""
        stagger, start, stop = (math.radians(self.law(key, v)) for key in ("stagger", "theta_in", "theta_out"))
        end = np.array([1.0, math.tan(stagger)])
        reach = self.law("dist_in", v), self.law("dist_out", v)
        b = [
            np.zeros(2),
            reach[0] * np.array([math.cos(start), math.sin(start)]),
            end - reach[1] * np.array([math.cos(stop), math.sin(stop)]),
            end,
        ]
        sides = []
        for name, sign in (("lower", -1.0), ("upper", 1.0)):
            radii = self.law("radius_in", v), self.law("radius_out", v)
            law = [radii[0], *(self.law(f"thickness_{name}_{i}", v) for i in range(1, 7)), radii[1]]
            points, normals = [], []
            for i in range(10):
                u = i / 9
                camber = (1 - u) ** 3 * b[0] + 3 * u * (1 - u) ** 2 * b[1] + 3 * u * u * (1 - u) * b[2] + u**3 * b[3]
                slope = (1 - u) ** 2 * (b[1] - b[0]) + 2 * u * (1 - u) * (b[2] - b[1]) + u * u * (b[3] - b[2])
                normal = np.array([-slope[1], slope[0]]) / math.hypot(*slope)
                points.append(camber + (sign * spline(law, u) * normal if 0 < i < 9 else 0.0))
                normals.append(normal)
            inserted = []
            for first, second, radius in ((0, 1, radii[0]), (9, 8, radii[1])):
                across = points[second] - points[first]
                height = math.sqrt(radius / 3 * abs(across[0] * normals[first][1] - across[1] * normals[first][0]))
                inserted.append(points[first] + sign * height * normals[first])
            sides.append([points[0], inserted[0], *points[1:9], inserted[1], points[9]])
        return sides

    def around(self, sides, u):
        """A point of a section: u runs along the lower side, and back along the upper."""
        return spline(sides[0], 2 * u) if u < 0.5 else spline(sides[1], 2 * (1 - u))

    def meridional(self, u, v):
        point = []
        for axis in "xz":
            first, last = self.laws[f"{axis}_leading"], self.laws[f"{axis}_trailing"]
            hub = [first[0], *self.laws[f"{axis}_hub"], last[0]]
            shroud = [first[-1], *self.laws[f"{axis}_shroud"], last[-1]]
            edges = (1 - u) * spline(first, v) + u * spline(last, v)
            walls = (1 - v) * spline(hub, u) + v * spline(shroud, u)
            corners = (1 - v) * ((1 - u) * first[0] + u * last[0]) + v * ((1 - u) * first[-1] + u * last[-1])
            point.append(edges + walls - corners)
        return np.array(point)

    def length(self, v):
        nodes, weights = np.polynomial.legendre.leggauss(10)
        total = 0.0
        for node, weight in zip(nodes, weights, strict=True):
            u = 1e-6 + (1 - 2e-6) * (node + 1) / 2
            slope = (self.meridional(u + 1e-3, v) - self.meridional(u - 1e-3, v)) / 2e-3
            total += weight * math.hypot(*slope) * (1 - 2e-6) / 2
        return total

    def rows(self, v, places):
        """Points at places around the sections, from hub to shroud; of the one section in two dimensions."""
        found = []
        for w in (0.0, 1.0) if self.two else v:
            sides = self.section(w)
            x = [self.around(sides, u)[0] for u in np.linspace(0, 1, 500)]
            low, high, length = min(x), max(x), self.length(w)
            row = []
            for u in places:
                at = self.around(sides, u)
                m = (at[0] - low + 1e-12) / (high - low + 2e-12)
                x, z = self.meridional(min(max(m, 0.0), 1.0), w)
                y = self.law("y_leading", w) + at[1] * length
                if self.annular and not self.two:
                    row.append([x, z * math.sin(y / z), z * math.cos(y / z)])
                else:
                    row.append([x, y, z])
            found.append(row)
        return np.mean(found, axis=0)[:, :2] if self.two else np.array(found)
