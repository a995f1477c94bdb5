"""Vectors as tuples of three numbers."""

import math

UP = (0.0, 1.0, 0.0)


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a, factor):
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return scale(a, 1 / length(a))


def mix(a, b, share):
    """The point between a (share 0) and b (share 1)."""
    return add(scale(a, 1 - share), scale(b, share))


def along(origin, *steps):
    """origin + vector * factor for each (vector, factor)."""
    for vector, factor in steps:
        origin = add(origin, scale(vector, factor))
    return origin


def frame(direction, up=UP):
    """Unit vectors (side, top) that are perpendicular to a direction and to each other; top leans toward `up`."""
    direction = unit(direction)
    if abs(dot(direction, unit(up))) > 0.999:
        up = (1.0, 0.0, 0.0) if abs(direction[0]) < 0.9 else (0.0, 0.0, 1.0)
    side = unit(cross(direction, up))
    return side, cross(side, direction)


def turned_about_y(p, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return (c * p[0] + s * p[2], p[1], -s * p[0] + c * p[2])
