"""A mesh in parts, and the shapes that the scenes are put together from.

Everything is as coarse as its form allows, as CAD exporters write it: a beam has 12 triangles, however long it is.
"""

import math

from generator.vectors import UP, add, along, cross, dot, frame, mix, scale, subtract, unit


class Mesh:
    """Parts of one material. A part is (vertices, faces, normals): faces are tuples of vertex numbers of the part,
    counter-clockwise seen from outside; normals are one for each vertex, or None for flat faces."""

    def __init__(self):
        self.parts = []

    def add(self, vertices, faces, normals=None):
        self.parts.append((list(vertices), [tuple(face) for face in faces], normals))

    def triangle_count(self):
        return sum(len(face) - 2 for _, faces, _ in self.parts for face in faces)

    def polygon(self, *points):
        """One flat convex polygon."""
        self.add(points, [range(len(points))])

    def extrusion(self, outline, step):
        """A prism over a convex outline, counter-clockwise seen against `step`."""
        n = len(outline)
        top = [add(p, step) for p in outline]
        sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
        self.add(list(outline) + top, [tuple(reversed(range(n))), tuple(range(n, 2 * n))] + sides)

    def box(self, low, high):
        """A box along the axes."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        self.extrusion([(x0, y0, z0), (x0, y0, z1), (x1, y0, z1), (x1, y0, z0)], (0, y1 - y0, 0))

    def beam(self, start, end, width, height, up=UP):
        """A straight beam, its axis from start to end; `height` is its size toward `up`."""
        side, top = frame(subtract(end, start), up)
        corners = [(-1, -1), (-1, 1), (1, 1), (1, -1)]
        outline = [along(start, (side, a * width / 2), (top, b * height / 2)) for a, b in corners]
        self.extrusion(outline, subtract(end, start))

    def tube(self, start, end, radius, sides=6, end_radius=None, smooth=False, caps=True):
        """A straight round bar with flat sides, or shaded as if it were round."""
        self.pipe([start, end], [radius, radius if end_radius is None else end_radius], sides, smooth=smooth, caps=caps)

    def pipe(self, points, radius, sides=6, closed=False, smooth=False, caps=True, up=UP):
        """A round bar along a line of points; `radius` is one number or one for each point."""
        n = len(points)
        radii = radius if isinstance(radius, list) else [radius] * n
        vertices, normals = [], []
        side = None
        for i, p in enumerate(points):
            before = points[i - 1] if closed or i > 0 else p
            after = points[(i + 1) % n] if closed or i + 1 < n else p
            direction = unit(subtract(after, before))
            if side is None:
                side, top = frame(direction, up)
            else:  # turned as little as possible from the ring before, so that the bar does not twist
                side = unit(subtract(side, scale(direction, dot(side, direction))))
                top = cross(side, direction)
            for k in range(sides):
                angle = 2 * math.pi * (k + 0.5) / sides
                out = add(scale(side, math.cos(angle)), scale(top, math.sin(angle)))
                vertices.append(add(p, scale(out, radii[i])))
                normals.append(out)
        faces = []
        for i in range(n if closed else n - 1):
            a, b = i * sides, (i + 1) % n * sides
            faces += [(a + k, b + k, b + (k + 1) % sides, a + (k + 1) % sides) for k in range(sides)]
        self.add(vertices, faces, normals if smooth else None)
        if caps and not closed:
            self.polygon(*vertices[:sides])
            self.polygon(*reversed(vertices[-sides:]))

    def lathe(self, profile, center, segments=24, axis=UP, smooth=True):
        """A profile of (radius, height) points turned about an axis through `center`; sharp where the profile has a
        point twice. Outside is to the right of the profile's direction."""
        side, top = frame(axis)
        axis = unit(axis)
        for run in _runs(profile):
            vertices, normals = [], []
            for (radius, height), (dr, dh) in zip(run, _slopes(run)):
                for k in range(segments):
                    angle = 2 * math.pi * k / segments
                    out = add(scale(side, math.cos(angle)), scale(top, math.sin(angle)))
                    vertices.append(along(center, (out, radius), (axis, height)))
                    normals.append(unit(add(scale(out, dh), scale(axis, -dr))))
            faces = []
            for i in range(len(run) - 1):
                a, b = i * segments, (i + 1) * segments
                for k in range(segments):
                    m = (k + 1) % segments
                    face = (a + k, b + k, b + m, a + m)
                    if run[i][0] == 0:
                        face = (a + k, b + k, b + m)
                    elif run[i + 1][0] == 0:
                        face = (a + k, b + k, a + m)
                    faces.append(face)
            self.add(vertices, faces, normals if smooth else None)

    def loft(self, rings, closed=False):
        """A smooth skin over rings of equally many points, each ring counter-clockwise seen from the ring before;
        `closed`: the last ring joins the first."""
        count, n = len(rings), len(rings[0])
        vertices = [p for ring in rings for p in ring]
        faces = []
        for i in range(count if closed else count - 1):
            a, b = i * n, (i + 1) % count * n
            faces += [(a + k, a + (k + 1) % n, b + (k + 1) % n, b + k) for k in range(n)]
        self.add(vertices, faces, _smooth_normals(vertices, faces))

    def moved(self, place, turn):
        """The same mesh with `place` applied to all points and `turn` to all normals."""
        mesh = Mesh()
        for vertices, faces, normals in self.parts:
            mesh.add([place(p) for p in vertices], faces, normals and [turn(p) for p in normals])
        return mesh

    def ribbon(self, left, right):
        """A strip between two lines of points, such as a leaf; the last points may be the same for a tip."""
        n = len(left)
        tip = left[-1] == right[-1]
        vertices = list(left) + list(right[:-1] if tip else right)
        faces = [(i, n + i, n + i + 1, i + 1) for i in range(n - 2)]
        faces.append((n - 2, 2 * n - 2, n - 1) if tip else (n - 2, 2 * n - 2, 2 * n - 1, n - 1))
        self.add(vertices, faces)

    def strings(self, starts, ends, radius, sides=3):
        """Straight strings, each from a start to its end."""
        for a, b in zip(starts, ends):
            self.tube(a, b, radius, sides, caps=False)


def _smooth_normals(vertices, faces):
    sums = [(0.0, 0.0, 0.0)] * len(vertices)
    for face in faces:
        a, b, c, d = (vertices[i] for i in face)
        normal = cross(subtract(c, a), subtract(d, b))
        for i in face:
            sums[i] = add(sums[i], normal)
    return [unit(normal) for normal in sums]


def _runs(profile):
    """The profile cut where a point stands twice."""
    runs = [[profile[0]]]
    for point in profile[1:]:
        if point == runs[-1][-1]:
            runs.append([])
        runs[-1].append(point)
    return runs


def _slopes(run):
    """The direction of a line of (radius, height) points at each of them."""
    last = len(run) - 1
    pairs = [(run[max(i - 1, 0)], run[min(i + 1, last)]) for i in range(len(run))]
    return [(b[0] - a[0], b[1] - a[1]) for a, b in pairs]


def circle(center, radius, count, axis=UP, start=0.0):
    """Points around a circle, clockwise seen against its axis, from `start` in turns."""
    side, top = frame(axis)
    angles = [2 * math.pi * (start + k / count) for k in range(count)]
    return [along(center, (side, radius * math.cos(a)), (top, radius * math.sin(a))) for a in angles]


def clipped_segment(a, b, outline):
    """What of the segment from a to b lies in a convex outline, all of it pairs of numbers, the outline
    counter-clockwise; None if nothing does."""
    low, high = 0.0, 1.0
    for (px, py), (qx, qy) in zip(outline, outline[1:] + outline[:1]):
        nx, ny = py - qy, qx - px  # inward
        at_a = nx * (a[0] - px) + ny * (a[1] - py)
        at_b = nx * (b[0] - px) + ny * (b[1] - py)
        if at_a < 0 and at_b < 0:
            return None
        if at_a < 0:
            low = max(low, at_a / (at_a - at_b))
        elif at_b < 0:
            high = min(high, at_a / (at_a - at_b))
    if low >= high:
        return None
    return tuple((a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t) for t in (low, high))


def curve(points, pieces):
    """A smooth line through points (Catmull-Rom), each stretch in so many pieces."""
    line = []
    for i in range(len(points) - 1):
        before, a, b, after = points[max(i - 1, 0)], points[i], points[i + 1], points[min(i + 2, len(points) - 1)]
        for k in range(pieces):
            t = k / pieces
            weights = (-t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2)
            line.append(tuple(sum(w * p[j] for w, p in zip(weights, (before, a, b, after))) / 2 for j in range(3)))
    return line + [points[-1]]


def spread(first, last, count):
    """`count` numbers or points from first to last, ends included."""
    if isinstance(first, tuple):
        return [mix(first, last, i / (count - 1)) for i in range(count)]
    return [first + (last - first) * i / (count - 1) for i in range(count)]
