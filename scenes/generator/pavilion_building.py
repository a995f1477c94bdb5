"""The building of the pavilion: x runs along the hall, y up, z across it from the plaster wall to the lattice."""

import math

from generator.mesh import clipped_segment, spread
from generator.vectors import add, along, mix, subtract, unit

LENGTH, WIDTH = 24.0, 11.0
LEFT_NEAR, RIGHT_NEAR, LEFT_FAR, RIGHT_FAR = 3.9, 7.4, 7.6, 3.5  # heights of the roof over the corners of the hall
DECK = 2.8  # height of the gallery
DECK_NEAR, DECK_RIGHT = 15.0, 8.1  # where it begins, and its edge toward the lattice
RAMP_NEAR = 3.2  # where the ramp to the gallery begins
STAIR = (9.3, 0.0, 6.8)  # axis of the spiral stair


def roof(x, z, below=0.0):
    """A point of the roof: a hyperbolic paraboloid, so all beams along x or z are straight though the roof is not."""
    near = LEFT_NEAR + (RIGHT_NEAR - LEFT_NEAR) * z / WIDTH
    far = LEFT_FAR + (RIGHT_FAR - LEFT_FAR) * z / WIDTH
    return (x, near + (far - near) * x / LENGTH - below, z)


def build(scene, random):
    _roof(scene, random)
    _columns(scene)
    _lattice(scene)
    _walls(scene)
    _floor(scene, random)
    _gallery(scene)


def _roof(scene, random):
    timbers = [scene.mesh(name) for name in ("oak", "oak_light", "oak_dark")]
    for x in spread(-1.6, LENGTH + 1.6, 80):  # fins across
        start, end = roof(x, -1.3, -0.12), roof(x, WIDTH + 1.5, -0.12)
        random.choices(timbers, (5, 4, 1))[0].beam(start, end, 0.05, 0.2)
    for z in spread(-0.9, WIDTH + 1.1, 14):  # purlins along
        timbers[0].beam(roof(-1.7, z, 0.08), roof(LENGTH + 1.7, z, 0.08), 0.08, 0.18)
    for x in spread(0.0, LENGTH, 7):  # main beams across, in pairs
        for side in (-0.14, 0.14):
            timbers[0].beam(roof(x + side, -0.7, 0.42), roof(x + side, WIDTH + 0.7, 0.42), 0.1, 0.5)
    steel = scene.mesh("steel")
    bays = spread(0.0, LENGTH, 7)
    for x0, x1 in zip(bays, bays[1:]):  # wind bracing: rods from corner to corner of each bay, and half bays
        for z0, z1 in ((0.2, WIDTH / 2), (WIDTH / 2, WIDTH - 0.2)):
            steel.tube(roof(x0, z0, 0.62), roof(x1, z1, 0.62), 0.012, 4)
            steel.tube(roof(x0, z1, 0.66), roof(x1, z0, 0.66), 0.012, 4)


def _columns(scene):
    """Struts in the form of a V under the eaves on both sides."""
    timber, steel = scene.mesh("oak_light"), scene.mesh("black")
    for x in spread(0.0, LENGTH, 7):
        for z in (0.3, WIDTH - 0.5):
            foot_height = 0.0 if z > 1 else _wall_top(x) - 0.3
            foot = (x, foot_height + 0.12, z)
            steel.box((x - 0.14, foot_height, z - 0.1), (x + 0.14, foot_height + 0.14, z + 0.1))
            spread_x = 1.5 if z > 1 else 0.7
            for side in (-1, 1):
                head = roof(min(max(x + side * spread_x, -0.7), LENGTH + 0.7), z, 0.05)
                timber.beam(foot, head, 0.12, 0.12)


def _lattice(scene):
    """Battens crossing on the open side, from the plinth to the sloping eave."""
    bottom, gap = 0.32, 0.75

    def top(x):
        return roof(x, WIDTH)[1] - 0.2

    outline = [(-1.2, bottom), (LENGTH + 1.2, bottom), (LENGTH + 1.2, top(LENGTH + 1.2)), (-1.2, top(-1.2))]
    lean = 8.0 / math.tan(math.radians(57))  # of a batten that rises by 8
    for layer, name in ((0, "oak"), (1, "oak_light")):
        z = WIDTH + 0.06 + 0.07 * layer
        for i in range(int((LENGTH + 2.4 + lean) / gap) + 1):
            foot = -1.2 - (lean if layer == 0 else 0) + i * gap
            a, b = (foot, bottom), (foot + (lean if layer == 0 else -lean), bottom + 8.0)
            inside = clipped_segment(a, b, outline)
            if inside and math.dist(*inside) > 0.3:
                start, end = [(x, y, z) for x, y in inside]
                scene.mesh(name).beam(start, end, 0.07, 0.045, up=(0, 0, 1))
    frame = scene.mesh("oak_dark")
    z = WIDTH + 0.1
    frame.beam((-1.25, bottom, z), (LENGTH + 1.25, bottom, z), 0.22, 0.1)
    frame.beam((-1.25, top(-1.25), z), (LENGTH + 1.25, top(LENGTH + 1.25), z), 0.22, 0.1)
    for x in (-1.2, LENGTH + 1.2):
        frame.beam((x, bottom, z), (x, top(x), z), 0.1, 0.22, up=(0, 0, 1))
    scene.mesh("concrete").box((-1.4, -0.15, WIDTH - 0.1), (LENGTH + 1.4, bottom - 0.05, WIDTH + 0.3))


def _wall_top(x):
    return roof(x, 0)[1] - 1.15


def _walls(scene):
    """A plaster wall that follows the roof with an open strip of light above it."""
    x0, x1, z = -2.5, LENGTH + 1.0, -0.35
    outline = [(x0, -0.15, z), (x1, -0.15, z), (x1, _wall_top(x1), z), (x0, _wall_top(x0), z)]
    scene.mesh("plaster").extrusion(outline, (0, 0, 0.35))
    coping = scene.mesh("black")
    coping.beam((x0, _wall_top(x0), -0.17), (x1, _wall_top(x1), -0.17), 0.39, 0.04)


def _floor(scene, random):
    """Slabs with open joints over a dark bed."""
    slabs = [scene.mesh("concrete"), scene.mesh("concrete_warm")]
    scene.mesh("joint").box((-6, -0.2, -0.05), (LENGTH + 2, -0.02, WIDTH + 0.05))
    for i in range(16):
        for j in range(6):
            x, z = -6 + 2 * i, -0.05 + 1.85 * j
            random.choice(slabs).box((x + 0.006, -0.1, z + 0.006), (x + 1.994, 0.0, z + 1.844))


def _gallery(scene):
    """A gallery at the far end over a closed room, with a wall of books under its edge."""
    end = LENGTH + 0.6
    scene.mesh("plaster_warm").box((DECK_NEAR + 0.9, 0, 0), (end, DECK - 0.26, DECK_RIGHT - 0.5))
    concrete = scene.mesh("concrete")
    concrete.box((DECK_NEAR, DECK - 0.26, 0), (end, DECK - 0.05, DECK_RIGHT))
    scene.mesh("oak").box((DECK_NEAR + 0.02, DECK - 0.05, 0.02), (end, DECK, DECK_RIGHT - 0.02))
    railing(scene, (DECK_NEAR + 0.06, DECK, 1.65), (DECK_NEAR + 0.06, DECK, STAIR[2]))
    railing(scene, (DECK_NEAR, DECK, DECK_RIGHT - 0.06), (end, DECK, DECK_RIGHT - 0.06))
    _bridge(scene)


def _bridge(scene):
    """From the spiral stair to the gallery."""
    x, _, z0 = STAIR
    z1 = DECK_RIGHT
    for z in (z0 + 0.05, z1 - 0.05):
        scene.mesh("black").beam((x, DECK - 0.15, z), (DECK_NEAR, DECK - 0.15, z), 0.06, 0.2)
    boards = 46
    for i in range(boards):
        middle = x + (DECK_NEAR - x) * (i + 0.5) / boards
        scene.mesh("oak").beam((middle, DECK - 0.025, z0), (middle, DECK - 0.025, z1), 0.11, 0.05)
    railing(scene, (x + 1.3, DECK, z0 + 0.05), (DECK_NEAR + 0.06, DECK, z0 + 0.05))
    railing(scene, (x, DECK, z1 - 0.05), (DECK_NEAR, DECK, z1 - 0.05))
    railing(scene, (x + 0.03, DECK, z0 + 0.1), (x + 0.03, DECK, z1 - 0.1))


def railing(scene, start, end, height=1.0, cables=8):
    """Posts, a timber handrail and cables, level or sloping."""
    steel, black = scene.mesh("steel"), scene.mesh("black")
    count = max(2, round(math.dist(start, end) / 1.3) + 1)
    for foot in spread(start, end, count):
        black.beam(foot, add(foot, (0, height - 0.03, 0)), 0.012, 0.045, up=unit(subtract(end, start)))
    for k in range(cables):
        rise = (0, 0.1 + (height - 0.2) * k / (cables - 1), 0)
        steel.tube(add(start, rise), add(end, rise), 0.004, 4, caps=False)
    heading, rise = unit(subtract(end, start)), (0, height, 0)
    rail = along(add(start, rise), (heading, -0.05)), along(add(end, rise), (heading, 0.05))
    scene.mesh("oak_light").beam(*rail, 0.06, 0.04)


def ramp(scene, random):
    """Along the plaster wall from the floor to the gallery."""
    width, thick = 1.45, 0.18
    near, far = RAMP_NEAR, DECK_NEAR
    z = 0.08
    outline = [(near, 0, z), (near + 0.6, 0, z), (far, DECK - thick - 0.03, z), (far, DECK - 0.03, z)]
    scene.mesh("concrete").extrusion(outline, (0, 0, width))
    slope = unit((far - near, DECK, 0))
    for z_rail in (z + 0.05, z + width - 0.05):
        railing(scene, (near + 0.15, 0.03, z_rail), (far - 0.02, DECK - 0.03, z_rail))
    boards = 130
    for i in range(boards):  # treads of timber across the ramp
        foot = mix((near + 0.1, 0.03, 0), (far - 0.05, DECK - 0.012, 0), (i + 0.5) / boards)
        timber = scene.mesh(random.choice(("oak", "oak", "oak_light")))
        start, end = (foot[0], foot[1], z + 0.12), (foot[0], foot[1], z + width - 0.12)
        timber.beam(start, end, 0.084, 0.03, up=(-slope[1], slope[0], 0))
    for x in (7.0, 10.0, 13.0):
        y = (x - near) / (far - near) * DECK - thick
        scene.mesh("black").tube((x, 0, z + width / 2), (x, y, z + width / 2), 0.06, 12, smooth=True)


def spiral_stair(scene):
    """Treads around a pole, balusters to a helical handrail."""
    x, _, z = STAIR
    steps, turn = 15, math.radians(27.0)
    radius = 1.2
    first = -steps * turn  # the last tread ends where the bridge begins

    def at(r, angle, y):
        return (x + r * math.cos(angle), y, z + r * math.sin(angle))

    black, steel, timber = scene.mesh("black"), scene.mesh("steel"), scene.mesh("oak_light")
    black.tube((x, 0, z), (x, DECK + 1.0, z), 0.07, 16, smooth=True)
    rail = []
    for i in range(steps):
        y = DECK * (i + 1) / steps
        a0 = first + i * turn - 0.04
        a1 = first + (i + 1) * turn + 0.04
        angles = spread(a0, a1, 4)
        outline = [at(0.06, a1, y), at(0.06, a0, y)] + [at(radius, a, y) for a in angles]
        timber.extrusion([(p[0], y - 0.05, p[2]) for p in reversed(outline)], (0, 0.05, 0))
        black.beam(at(0.05, (a0 + a1) / 2, y - 0.09), at(radius - 0.1, (a0 + a1) / 2, y - 0.06), 0.04, 0.06)
        for k in range(3):
            a = first + (i + (k + 0.5) / 3) * turn
            top = DECK * (i + (k + 0.5) / 3 + 0.5) / steps + 0.95
            steel.tube(at(radius - 0.04, a, y - 0.12), at(radius - 0.04, a, top), 0.009, 6, caps=False)
            rail.append(at(radius - 0.04, a, top))
    timber.pipe(rail, 0.028, 8, smooth=True)
    string = [(p[0], p[1] - 1.0, p[2]) for p in rail]
    black.pipe(string, 0.03, 6)
