"""What turns on the bicycle: wheels, chain and cranks."""

import math

from generator.mesh import spread
from generator.vectors import add, along, subtract

AXIS = (0.0, 0.0, 1.0)


def around(center, radius, angle, z=0.0):
    return add(center, (radius * math.cos(angle), radius * math.sin(angle), z))


def ring(mesh, center, profile, segments=72):
    """A closed profile of (radius, z) points, clockwise with z upward over the radius, turned about the axle."""
    rings = []
    for k in range(segments):
        angle = 2 * math.pi * k / segments
        rings.append([around(center, r, angle, z) for r, z in profile])
    mesh.loft(rings, closed=True)


def wheel(parts, center, half_hub, spokes, driven=False):
    turns = [-2 * math.pi * k / 12 for k in range(12)]
    tyre = [(0.329 + 0.0145 * math.cos(a), 0.0145 * math.sin(a)) for a in turns]
    ring(parts["rubber"], center, tyre, 80)
    for side in (-1, 1):  # tan sides, a little outside the tyre's
        wall = [(0.318, 0.0115 * side), (0.326, 0.0152 * side), (0.335, 0.0132 * side), (0.326, 0.011 * side)]
        ring(parts["tan"], center, wall if side > 0 else wall[::-1], 80)
    rim = [(0.318, 0.0115), (0.32, 0.0), (0.318, -0.0115), (0.302, -0.004), (0.302, 0.004)]
    ring(parts["chrome"], center, rim, 80)
    _hub(parts, center, half_hub)
    _spokes(parts, center, half_hub - 0.018, spokes)
    if driven:
        for r, z in ((0.034, 0.046), (0.04, 0.0425), (0.046, 0.039), (0.052, 0.0355)):
            gear(parts["steel"], add(center, (0, 0, z)), r, round(r / 0.002), 0.0018)


def _hub(parts, center, half):
    profile = [(0.0, -half), (0.008, -half), (0.008, -half), (0.008, -half + 0.016), (0.024, -half + 0.016),
               (0.024, -half + 0.016), (0.024, -half + 0.02), (0.024, -half + 0.02), (0.011, -half + 0.026)]
    profile += [(r, -z) for r, z in reversed(profile)]
    parts["chrome"].lathe(profile, center, 24, axis=AXIS)


def _spokes(parts, center, flange, count):
    """Laced so that each crosses three others of its side; the four in a group go forward and back on either side."""
    for k in range(count):
        side = 1 if k % 2 else -1
        forward = 1 if k % 4 < 2 else -1
        at_rim = 2 * math.pi * k / count
        at_hub = at_rim + forward * math.radians(68)
        hub = around(center, 0.0215, at_hub, side * flange)
        rim = around(center, 0.303, at_rim, side * 0.002)
        parts["chrome"].tube(hub, rim, 0.0013, 6, smooth=True)
        parts["steel"].tube(around(center, 0.291, at_rim + forward * 0.004, side * 0.0035), rim, 0.0022, 6)


def gear(mesh, center, radius, teeth, half_thick, inside=0.55):
    """A toothed ring."""
    outer, inner = [], []
    for k in range(teeth):
        for share, r in ((0.0, 0.95), (0.22, 0.955), (0.4, 1.04), (0.6, 1.04), (0.78, 0.955)):
            angle = 2 * math.pi * (k + share) / teeth
            outer.append((radius * r, angle))
            inner.append((radius * inside, angle))
    n = len(outer)
    vertices = [around(center, r, a, z) for z in (-half_thick, half_thick) for line in (outer, inner) for r, a in line]
    faces = []
    for k in range(n):
        m = (k + 1) % n
        faces += [(k, n + k, n + m, m), (2 * n + k, 2 * n + m, 3 * n + m, 3 * n + k)]  # the flat sides
        faces += [(k, m, 2 * n + m, 2 * n + k), (n + m, n + k, 3 * n + k, 3 * n + m)]  # outside, inside
    mesh.add(vertices, faces)


def drive(parts, bottom, rear):
    line = 0.046
    big, small = 0.098, 0.034
    front = add(bottom, (0, 0, line))
    gear(parts["chrome"], front, big, 46, 0.0016, inside=0.86)
    for k in range(5):
        angle = 2 * math.pi * k / 5 + 0.3
        start, end = around(front, 0.012, angle, 0.003), around(front, big * 0.88, angle, 0.001)
        parts["chrome"].beam(start, end, 0.016, 0.004, up=AXIS)
    parts["steel"].tube(add(bottom, (0, 0, -0.068)), add(bottom, (0, 0, 0.068)), 0.009, 12)
    for side, angle in ((1, math.radians(-38)), (-1, math.radians(142))):
        hub, end = add(bottom, (0, 0, side * 0.062)), around(bottom, 0.17, angle, side * 0.07)
        parts["chrome"].beam(hub, end, 0.022, 0.011, up=AXIS)
        for place in (hub, end):
            parts["chrome"].tube(add(place, (0, 0, -0.008)), add(place, (0, 0, 0.008)), 0.014, 16, smooth=True)
        _pedal(parts, end, side)
    _chain(parts["steel"], front, big * 1.0, add(rear, (0, 0, line)), small)


def _pedal(parts, center, side):
    a, b = 0.018 * side, 0.108 * side
    parts["chrome"].tube(center, add(center, (0, 0, b)), 0.005, 8)
    for x in (-0.036, 0.036):
        parts["steel"].beam(add(center, (x, 0, a)), add(center, (x, 0, b)), 0.006, 0.02)
    for z in (a, (a + b) / 2, b):
        parts["steel"].beam(add(center, (-0.036, 0, z)), add(center, (0.036, 0, z)), 0.004, 0.014)


def _chain(mesh, front, big, rear, small):
    """Links along the line around two sprockets."""
    span = subtract(front, rear)
    distance = math.hypot(span[0], span[1])
    heading = math.atan2(span[1], span[0])
    tilt = math.asin((big - small) / distance)
    up, down = heading + math.pi / 2 + tilt, heading - math.pi / 2 - tilt  # where the straight runs touch
    steps = 40
    points = [around(front, big, a) for a in spread(up, down, steps)]
    points += [around(rear, small, a) for a in spread(down, up - 2 * math.pi, steps)]
    points.append(points[0])
    line = _even(points, 0.0127 / 2)
    for k, (a, b) in enumerate(zip(line, line[1:])):
        z = 0.0035 if k % 2 else 0.002
        for side in (-1, 1):
            mesh.beam(add(a, (0, 0, side * z)), add(b, (0, 0, side * z)), 0.0085, 0.001, up=AXIS)


def _even(points, step):
    """Points at even distances along a line."""
    line, left = [points[0]], step
    for a, b in zip(points, points[1:]):
        reach, done = math.dist(a, b), 0.0
        while reach - done >= left:
            done += left
            line.append(along(a, (subtract(b, a), done / reach)))
            left = step
        left -= reach - done
    return line
