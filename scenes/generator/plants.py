"""Plants of long thin leaves."""

import math

from generator.vectors import UP, add, along, cross, unit


def blade(mesh, foot, heading, height, reach, width, pieces=3):
    """A leaf that rises from its foot and bends over toward a heading (an angle about y)."""
    out = (math.cos(heading), 0.0, math.sin(heading))
    side = cross(out, UP)
    left, right = [], []
    for i in range(pieces + 1):
        t = i / pieces
        point = along(foot, (out, reach * t * t), (UP, height * math.sin(t * math.pi * 0.58) / math.sin(math.pi * 0.5)))
        half = width / 2 * (1 - t) ** 0.6 * (0.6 + 0.8 * t * (1 - t) * 2)
        left.append(along(point, (side, -half)))
        right.append(along(point, (side, half)))
    left[-1] = right[-1] = point
    mesh.ribbon(left, right)


def tuft(mesh, random, foot, count, height, reach, width, radius=0.06, pieces=3):
    """Many blades from one place, in all directions."""
    for _ in range(count):
        heading = random.uniform(0, 2 * math.pi)
        size = random.uniform(0.6, 1.0)
        start = along(foot, ((math.cos(heading), 0, math.sin(heading)), radius * random.random()))
        blade(mesh, start, heading, height * size, reach * size * random.uniform(0.5, 1.0), width, pieces)


def pot(mesh, soil, foot, radius, height, segments=28):
    """A tapered pot with a rim, and the soil in it."""
    r = radius
    inside = r * 0.88
    profile = [(0, 0), (r * 0.72, 0), (r * 0.72, 0), (r, height), (r, height), (inside, height), (inside, height),
               (inside * 0.95, height * 0.9)]
    mesh.lathe(profile, foot, segments)
    soil.lathe([(inside * 0.96, height * 0.92), (0, height * 0.92)], foot, segments)


def fan_leaf(mesh, random, foot, stem_end, size, fingers=9):
    """A leaf of fingers from the end of a stem, as of a fan palm."""
    out = unit((stem_end[0] - foot[0], 0.25, stem_end[2] - foot[2]))
    side = unit(cross(out, UP))
    lift = cross(side, out)
    for k in range(fingers):
        angle = math.radians(-75 + 150 * k / (fingers - 1))
        direction = add(tuple(c * math.cos(angle) for c in out), tuple(c * math.sin(angle) for c in side))
        across = cross(direction, lift)
        long = size * (0.75 + 0.25 * math.cos(angle)) * random.uniform(0.92, 1.08)
        middle = along(stem_end, (direction, long * 0.55), (lift, 0.05 * size))
        tip = along(stem_end, (direction, long), (UP, -0.22 * size))
        half = 0.045 * size
        left = [stem_end, along(middle, (across, -half)), tip]
        right = [along(stem_end, (across, 0.004)), along(middle, (across, half)), tip]
        mesh.ribbon(left, right)
