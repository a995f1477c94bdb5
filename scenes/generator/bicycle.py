"""A bicycle in a studio: tubes and spokes at all angles."""

import math

from generator import bicycle_wheels as wheels
from generator.mesh import Mesh, curve, spread
from generator.scene import Scene
from generator.vectors import add, along, mix, unit

DESCRIPTION = (
    "A bicycle in a studio, on its stand. Spokes, tubes and wires are long thin triangles at all angles, as in any CAD "
    "assembly: their boxes are mostly empty, until they are split."
)

REAR, FRONT = (0.0, 0.345, 0.0), (1.02, 0.345, 0.0)  # axles
BOTTOM = (0.435, 0.28, 0.0)  # bottom bracket
SEAT_AXIS = unit((-0.292, 0.956, 0.0))  # of seat tube and steering, upward
AHEAD = (0.956, 0.292, 0.0)  # perpendicular to it
CLUSTER = along(BOTTOM, (SEAT_AXIS, 0.55))  # where seat tube, top tube and seat stays meet
HEAD_LOW = along(FRONT, (SEAT_AXIS, 0.385), (AHEAD, -0.05))
HEAD_HIGH = along(HEAD_LOW, (SEAT_AXIS, 0.16))
LEAN = math.radians(-7)  # on its stand, to the left


def scene():
    scene = Scene("bicycle", DESCRIPTION, turn=28, move=(-0.5, 0.0, 0.0))
    scene.settings = {
        "background_color": (0.55, 0.29, 0.19),
        "background_intensity": 0.8,
        "ambient_light": 0.06,
        "structure": "early_split(budget=2)+binned_sah",
    }
    _materials(scene)
    _studio(scene)
    parts = Parts()
    wheels.wheel(parts, REAR, 0.065, 36, driven=True)
    wheels.wheel(parts, FRONT, 0.05, 32)
    _frame(parts)
    _fork(parts)
    _bars(parts)
    _saddle(parts)
    wheels.drive(parts, BOTTOM, REAR)
    _rack(parts)
    for material, mesh in parts.items():
        scene.mesh(material).parts += mesh.moved(leaning, leaning).parts
    scene.look(eye=(1.4, 1.05, 3.1), look_at=(0.52, 0.37, 0.0), fov=27.5)
    return scene


class Parts(dict):
    """A mesh for each material, made when it is first asked for."""

    def __missing__(self, material):
        return self.setdefault(material, Mesh())


def leaning(p):
    c, s = math.cos(LEAN), math.sin(LEAN)
    return (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])


def _materials(scene):
    scene.material("paint", "metal", albedo=(0.02, 0.22, 0.23), roughness=0.35, metallic=0.3)
    scene.material("chrome", "metal", albedo=(0.78, 0.78, 0.80), roughness=0.5)
    scene.material("steel", "metal", albedo=(0.55, 0.55, 0.57), roughness=0.5)
    scene.material("rubber", "lambertian", albedo=(0.035, 0.035, 0.037))
    scene.material("tan", "lambertian", albedo=(0.55, 0.35, 0.18))
    scene.material("leather", "lambertian", albedo=(0.30, 0.13, 0.055))
    scene.material("podium", "lambertian", albedo=(0.74, 0.72, 0.69))
    scene.material("softbox", "light", emission=(13.5, 12.6, 11))


def _studio(scene):
    """A round podium under one soft light; the rest is the background."""
    for radius, low, high in ((0.98, -0.06, 0.0), (1.06, -0.16, -0.06)):
        profile = [(0, low), (radius, low), (radius, low), (radius, high), (radius, high), (0, high)]
        scene.mesh("podium").lathe(profile, (0.5, 0, 0), 96)
    scene.rectangle("softbox", (1.1, 2.6, 0.4), (1.4, 0, 1.0), (-0.74, 0.74, 1.12), "One soft light", visible=False)


def _tube(parts, start, end, radius, end_radius=None):
    parts["paint"].tube(start, end, radius, 16, end_radius, smooth=True)


def _frame(parts):
    _tube(parts, BOTTOM, along(CLUSTER, (SEAT_AXIS, 0.02)), 0.0145)
    _tube(parts, CLUSTER, along(HEAD_HIGH, (SEAT_AXIS, -0.03)), 0.013)
    _tube(parts, BOTTOM, along(HEAD_LOW, (SEAT_AXIS, 0.035)), 0.0155)
    _tube(parts, HEAD_LOW, HEAD_HIGH, 0.018)
    for side in (-1, 1):
        drop = add(REAR, (0, 0, side * 0.066))
        _tube(parts, add(CLUSTER, (0, -0.01, side * 0.014)), drop, 0.0085, 0.006)
        _tube(parts, add(BOTTOM, (-0.01, 0, side * 0.028)), drop, 0.0105, 0.007)
        parts["chrome"].tube(add(drop, (0, 0, -0.004)), add(drop, (0, 0, 0.004)), 0.016, 16)
    _tube(parts, add(BOTTOM, (0, 0, -0.034)), add(BOTTOM, (0, 0, 0.034)), 0.02)
    for center in (HEAD_LOW, HEAD_HIGH):
        low, high = along(center, (SEAT_AXIS, -0.006)), along(center, (SEAT_AXIS, 0.006))
        parts["chrome"].tube(low, high, 0.021, 20, smooth=True)
    parts["chrome"].tube(add(BOTTOM, (-0.06, -0.02, -0.03)), (BOTTOM[0] - 0.19, 0.012, -0.19), 0.007, 8)  # the stand
    for k in range(3):  # cables along the down tube
        rise = (0, -0.017, 0.004 * (k - 1))
        parts["rubber"].tube(add(mix(BOTTOM, HEAD_LOW, 0.1), rise), add(mix(BOTTOM, HEAD_LOW, 0.93), rise), 0.0012, 4)


def _fork(parts):
    crown = along(HEAD_LOW, (SEAT_AXIS, -0.012))
    parts["chrome"].beam(add(crown, (0, 0, -0.045)), add(crown, (0, 0, 0.045)), 0.024, 0.02, up=SEAT_AXIS)
    for side in (-1, 1):
        top = add(crown, (0, 0, side * 0.042))
        end = add(FRONT, (0, 0, side * 0.052))
        middle = along(top, (SEAT_AXIS, -0.23))
        low = along(top, (SEAT_AXIS, -0.32), (AHEAD, 0.014))
        line = curve([top, middle, low, end], 4)
        parts["paint"].pipe(line, spread(0.0115, 0.0065, len(line)), 14, smooth=True)
        parts["chrome"].tube(add(end, (0, 0, -0.004)), add(end, (0, 0, 0.004)), 0.014, 16)


def _bars(parts):
    quill = along(HEAD_HIGH, (SEAT_AXIS, 0.055))
    clamp = add(quill, (0.095, 0.012, 0))
    parts["chrome"].tube(HEAD_HIGH, along(quill, (SEAT_AXIS, 0.01)), 0.011, 16, smooth=True)
    parts["chrome"].tube(quill, clamp, 0.011, 16, smooth=True)
    parts["chrome"].tube(add(clamp, (0, 0, -0.02)), add(clamp, (0, 0, 0.02)), 0.018, 20, smooth=True)
    for side in (-1, 1):
        shape = [(0, 0, 0), (0, 0, 0.12), (0.025, 0, 0.18), (0.075, -0.005, 0.2), (0.108, -0.045, 0.205),
                 (0.095, -0.1, 0.21), (0.045, -0.132, 0.212), (-0.06, -0.137, 0.215)]
        line = curve([add(clamp, (x, y, z * side)) for x, y, z in shape], 5)
        parts["chrome"].pipe(line[:7], 0.012, 14, smooth=True)
        parts["leather"].pipe(line[6:], 0.015, 14, smooth=True)
        hood = line[19]
        lever = [(0, 0, 0), (0.03, 0.022, 0), (0.045, -0.03, 0), (0.028, -0.1, side * 0.008)]
        lever = [add(hood, p) for p in lever]
        parts["leather"].pipe(curve(lever[:2], 2), 0.014, 10, smooth=True)
        parts["chrome"].pipe(curve(lever[1:], 4), [0.007] * 8 + [0.004], 8, smooth=True)
        loop = [lever[1], add(clamp, (0.12, 0.12, side * 0.1)), add(clamp, (0.06, 0.02, side * 0.02)),
                add(HEAD_HIGH, (0.03, -0.06, side * 0.02))]
        parts["rubber"].pipe(curve(loop, 8), 0.0022, 6, smooth=True)


def _saddle(parts):
    post = along(CLUSTER, (SEAT_AXIS, 0.13))
    parts["chrome"].tube(CLUSTER, post, 0.0115, 16, smooth=True)
    seat = add(post, (-0.01, 0.05, 0))
    rings = []
    for t in spread(0.0, 1.0, 15):  # from the back to the nose
        x = -0.135 + 0.27 * t
        half = 0.016 + 0.06 * (1 - t) ** 1.5 * min(1.0, 0.55 + 6 * t)
        drop = 0.022 + 0.02 * (1 - t)
        rise = 0.012 * (2 * t - 1) ** 2
        ring = []
        for k in range(16):
            a = 2 * math.pi * k / 16
            y = math.sin(a)
            ring.append(add(seat, (x, rise + (0.006 * y if y > 0 else drop * y), half * math.cos(a))))
        rings.append(ring)
    parts["leather"].loft(rings)
    for ring in (rings[0], rings[-1]):
        parts["leather"].polygon(*(reversed(ring) if ring is rings[0] else ring))
    for side in (-1, 1):
        rail = ((-0.1, -0.045, side * 0.04), (0.0, -0.052, side * 0.024), (0.11, -0.02, side * 0.012))
        parts["chrome"].pipe(curve([add(seat, p) for p in rail], 5), 0.0035, 8, smooth=True)
        spring = []
        for k in range(97):  # coil springs under the back
            a = 2 * math.pi * k / 16
            x, z = 0.014 * math.cos(a) - 0.105, 0.014 * math.sin(a) + side * 0.045
            spring.append(add(seat, (x, -0.055 + 0.04 * k / 96, z)))
        parts["chrome"].pipe(spring, 0.0024, 6, smooth=True)
    parts["chrome"].tube(add(seat, (-0.02, -0.052, -0.03)), add(seat, (-0.02, -0.052, 0.03)), 0.012, 12, smooth=True)


def _rack(parts):
    """A rack of thin rods over the rear wheel."""
    level = 0.735
    for z in spread(-0.055, 0.055, 5):
        parts["chrome"].tube((-0.27, level, z), (0.17, level, z), 0.0035, 8)
    for x in (-0.27, -0.15, 0.0, 0.12):
        parts["chrome"].tube((x, level - 0.006, -0.06), (x, level - 0.006, 0.06), 0.0035, 8)
    for side in (-1, 1):
        foot = add(REAR, (0, 0.02, side * 0.075))
        for x in (-0.2, -0.06):
            parts["chrome"].tube(foot, (x, level, side * 0.057), 0.0035, 8)
        parts["chrome"].tube((0.17, level, side * 0.055), add(CLUSTER, (-0.03, -0.06, side * 0.018)), 0.0035, 8)
