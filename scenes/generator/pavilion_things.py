"""What stands in and around the pavilion."""

import math

from generator import plants
from generator.mesh import circle, spread
from generator.pavilion_building import DECK_NEAR, DECK_RIGHT, LENGTH, WIDTH, roof
from generator.vectors import add, along, turned_about_y


class Placed:
    """A mesh seen from a thing that stands at a foot, turned by an angle."""

    def __init__(self, mesh, foot, degrees):
        self.mesh, self.foot, self.degrees = mesh, foot, degrees

    def at(self, p):
        return add(turned_about_y(p, self.degrees), self.foot)

    def beam(self, start, end, width, height, up=(0, 1, 0)):
        self.mesh.beam(self.at(start), self.at(end), width, height, turned_about_y(up, self.degrees))

    def tube(self, start, end, radius, sides=6, **keys):
        self.mesh.tube(self.at(start), self.at(end), radius, sides, **keys)

    def box(self, low, high):
        (x0, y0, z0), (x1, y1, z1) = low, high
        outline = [(x0, y0, z0), (x0, y0, z1), (x1, y0, z1), (x1, y0, z0)]
        self.mesh.extrusion([self.at(p) for p in outline], (0, y1 - y0, 0))


def furnish(scene, random):
    _table(scene, random)
    _sculptures(scene)
    _easels(scene)
    _books(scene, random)
    _plants(scene, random)
    _landscape(scene, random)


def _table(scene, random):
    """A long table on a rug, with chairs, lamps and what lies on it."""
    center, degrees = (7.3, 0.0, 3.75), 0
    scene.mesh("blue").box((4.5, 0.0, 2.3), (10.1, 0.012, 5.2))
    top = Placed(scene.mesh("oak_light"), center, degrees)
    for k in range(5):
        z = -0.4 + 0.2 * k
        top.box((-2.1, 0.72, z - 0.098), (2.1, 0.76, z + 0.098))
    legs = Placed(scene.mesh("black"), center, degrees)
    for x in (-1.5, 1.5):
        for side in (-1, 1):
            legs.beam((x - 0.25 * side, 0, -0.42), (x + 0.25 * side, 0.72, 0.4), 0.04, 0.04)
            legs.beam((x + 0.25 * side, 0, 0.42), (x - 0.25 * side, 0.72, -0.4), 0.04, 0.04)
    legs.tube((-1.5, 0.36, 0), (1.5, 0.36, 0), 0.015)
    colours = ["oak_dark", "ochre", "oak_dark", "oak_dark", "oak_dark", "oak_dark", "ochre", "oak_dark"]
    for i, x in enumerate((-1.5, -0.5, 0.5, 1.5)):
        for side in (-1, 1):
            foot = (x + random.uniform(-0.06, 0.06), 0.012, side * random.uniform(0.72, 0.84))
            turn = degrees + (0 if side > 0 else 180) + random.uniform(-14, 14)
            _chair(scene, colours[2 * i + (side > 0)], legs.at(foot), turn)
    for x, comment in ((-1.35, "Bulbs of the lamps over the table"), (0.0, ""), (1.35, "")):
        _lamp(scene, legs.at((x, 2.1, 0)), comment)
    _tableware(scene, center)


def _chair(scene, material, foot, degrees):
    """A chair with splayed legs and a back of thin rods; it looks toward -z."""
    wood = Placed(scene.mesh(material), foot, degrees)
    wood.box((-0.22, 0.43, -0.22), (0.22, 0.46, 0.22))
    for sx in (-1, 1):
        for sz in (-1, 1):
            wood.tube((sx * 0.17, 0.43, sz * 0.16), (sx * 0.24, 0.0, sz * 0.23), 0.019, 8, end_radius=0.012)
        wood.tube((sx * 0.2, 0.22, -0.19), (sx * 0.2, 0.22, 0.19), 0.009, 6)
    count = 8
    for k in range(count):
        a = -1 + 2 * k / (count - 1)
        foot_point = (0.19 * a, 0.46, 0.21 - 0.03 * a * a)
        head = (0.25 * a, 0.84, 0.33 - 0.09 * a * a)
        wood.tube(foot_point, head, 0.007, 6)
    arc = [(0.27 * a, 0.85, 0.335 - 0.1 * a * a) for a in spread(-1.0, 1.0, 9)]
    wood.mesh.pipe([wood.at(p) for p in arc], 0.017, 8, smooth=True)


def _lamp(scene, center, comment):
    """A lamp of strings between two rings, turned against each other, hung from the roof."""
    x, y, z = center
    count = 44
    low = circle((x, y - 0.24, z), 0.32, count)
    high = circle((x, y + 0.24, z), 0.2, count)
    strings = scene.mesh("paper")
    for turn in (11, -11):
        strings.strings(low, high[turn:] + high[:turn], 0.0022)
    black = scene.mesh("black")
    black.pipe(circle((x, y - 0.24, z), 0.32, 40), 0.006, 6, closed=True, smooth=True)
    black.pipe(circle((x, y + 0.24, z), 0.2, 32), 0.006, 6, closed=True, smooth=True)
    black.tube((x, y + 0.05, z), roof(x, z), 0.004, 4)
    scene.sphere("bulb", (x, y, z), 0.05, comment)


def _tableware(scene, center):
    x, y, z = add(center, (0, 0.76, 0))
    bowl = [(0.05, 0.0), (0.13, 0.03), (0.17, 0.09), (0.17, 0.09), (0.164, 0.09), (0.164, 0.09),
            (0.12, 0.035), (0, 0.025)]
    scene.mesh("blue").lathe(bowl, (x - 1.1, y, z + 0.05), 32)
    for dx, dz in ((-1.13, 0.03), (-1.06, 0.1), (-1.08, -0.02)):
        scene.sphere("ochre", (x + dx, y + 0.075, z + dz), 0.042)
    vase = [(0, 0), (0.05, 0), (0.085, 0.08), (0.07, 0.17), (0.028, 0.24), (0.034, 0.28)]
    scene.mesh("paper").lathe(vase, (x + 0.35, y, z - 0.1), 32)
    for k in range(9):
        heading = 0.7 * k
        out = (math.cos(heading), 0, math.sin(heading))
        end = along((x + 0.35, y + 0.28, z - 0.1), (out, 0.1 + 0.02 * (k % 3)), ((0, 1, 0), 0.3 + 0.05 * (k % 4)))
        scene.mesh("leaf").tube((x + 0.35, y + 0.1, z - 0.1), end, 0.003, 4, caps=False)
        plants.fan_leaf(scene.mesh("leaf_light"), _Middle(), (x + 0.35, y, z - 0.1), end, 0.12, 5)
    scene.sphere("glass", (x - 0.45, y + 0.07, z + 0.22), 0.07, "A paperweight")
    for k, material in enumerate(("terracotta", "paper", "blue")):
        book = Placed(scene.mesh(material), (x + 1.2, y + 0.035 * k, z), 12 + 21 * k)
        book.box((-0.12, 0, -0.16), (0.12, 0.033, 0.16))


class _Middle:
    """Stands for random numbers where none are wanted."""

    def uniform(self, low, high):
        return (low + high) / 2


def _sculptures(scene):
    """A ball of glass on a plinth, one of brass on the floor, and strings between two rings."""
    scene.mesh("plaster").box((2.97, 0, 6.47), (3.43, 1.0, 6.93))
    scene.sphere("glass", (3.2, 1.2, 6.7), 0.2, "Balls of glass, on the plinth, and of brass, on the floor")
    scene.sphere("brass", (4.6, 0.45, 6.95), 0.45)
    _string_sculpture(scene, (8.4, 0.0, 9.3))


def _string_sculpture(scene, foot):
    """Two rings, one over the other, and strings that cross between them: a hyperboloid of straight lines."""
    x, y, z = foot
    scene.mesh("plaster").box((x - 0.6, 0, z - 0.6), (x + 0.6, 0.35, z + 0.6))
    count = 96
    low, high = circle((x, 0.4, z), 0.5, count), circle((x, 2.6, z), 0.66, count)
    strings = scene.mesh("red")
    for turn in (34, -34):
        strings.strings(low, high[turn:] + high[:turn], 0.003)
    for center, radius in (((x, 0.4, z), 0.5), ((x, 2.6, z), 0.66)):
        scene.mesh("black").pipe(circle(center, radius, 48), 0.014, 8, closed=True, smooth=True)


def _easels(scene):
    for foot, degrees, canvas, accent in (((11.2, 0.0, 2.9), 76, "paper", "terracotta"),
                                          ((12.4, 0.0, 4.6), 100, "ochre", "blue")):
        wood = Placed(scene.mesh("oak"), foot, degrees)
        for sx in (-1, 1):
            wood.beam((sx * 0.42, 0, 0.0), (sx * 0.06, 1.95, -0.28), 0.045, 0.025, up=(0, 0, 1))
        wood.beam((0, 0, -0.85), (0, 1.9, -0.27), 0.045, 0.025, up=(0, 0, 1))
        wood.beam((-0.45, 0.72, -0.07), (0.45, 0.72, -0.07), 0.06, 0.03)
        picture = Placed(scene.mesh(canvas), foot, degrees)
        lean = (0, 1.0, -0.142)
        low = (0, 0.74, -0.06)
        picture.beam(low, along(low, (lean, 0.95)), 0.8, 0.03, up=(0, 0, 1))
        mark = Placed(scene.mesh(accent), foot, degrees)
        mark.beam(along(low, (lean, 0.2), ((1, 0, 0), -0.1), ((0, 0, 1), 0.012)),
                  along(low, (lean, 0.62), ((1, 0, 0), -0.1), ((0, 0, 1), 0.012)), 0.4, 0.03, up=(0, 0, 1))
        mark = Placed(scene.mesh("black"), foot, degrees)
        mark.beam(along(low, (lean, 0.12), ((1, 0, 0), 0.2), ((0, 0, 1), 0.014)),
                  along(low, (lean, 0.85), ((1, 0, 0), 0.25), ((0, 0, 1), 0.014)), 0.03, 0.03, up=(0, 0, 1))


def _books(scene, random):
    """Shelves under the gallery, full of books of which some lean."""
    x, wood = DECK_NEAR + 0.9, scene.mesh("oak_dark")
    z0, z1, depth = 1.75, DECK_RIGHT - 0.6, 0.32
    colours = ["paper", "paper", "terracotta", "ochre", "blue", "black", "plaster_warm", "oak", "leaf"]
    heights = spread(0.08, 2.42, 8)
    for y in heights:
        wood.box((x - depth, y - 0.02, z0), (x, y, z1))
    bays = spread(z0, z1, 5)
    for z in bays:
        wood.box((x - depth, 0, z - 0.015), (x, 2.44, z + 0.015))
    for y, above in zip(heights, heights[1:]):
        for a, b in zip(bays, bays[1:]):
            z = a + 0.03
            while z < b - 0.08 and random.random() > 0.012:
                thick, tall = random.uniform(0.016, 0.05), random.uniform(0.19, above - y - 0.04)
                lean = 0.06 if random.random() < 0.06 else 0.0
                back = random.uniform(0.03, 0.1)
                book = scene.mesh(random.choice(colours))
                foot = (x - depth + back + 0.1, y, z + thick / 2)
                book.beam(foot, add(foot, (0, tall, lean)), thick * 0.94, 0.2, up=(1, 0, 0))
                z += thick + lean


def _plants(scene, random):
    pot, soil = scene.mesh("terracotta"), scene.mesh("joint")
    for foot, radius, height in (((5.6, 0, 9.9), 0.34, 0.55), ((12.6, 0, 9.9), 0.3, 0.5), ((3.7, 0, 2.2), 0.24, 0.42)):
        plants.pot(pot, soil, foot, radius, height)
        plants.tuft(scene.mesh("leaf"), random, add(foot, (0, height * 0.9, 0)), 90, 1.5, 0.9, 0.035, pieces=5)
        plants.tuft(scene.mesh("leaf_light"), random, add(foot, (0, height * 0.9, 0)), 50, 1.2, 0.7, 0.03, pieces=5)
    foot = (17.4, 0, 9.4)
    plants.pot(scene.mesh("plaster"), soil, foot, 0.4, 0.7)
    for k in range(26):  # a fan palm
        heading, rise = random.uniform(0, 2 * math.pi), random.uniform(0.5, 1.9)
        out = (math.cos(heading), 0, math.sin(heading))
        base = add(foot, (0, 0.6, 0))
        end = along(base, (out, random.uniform(0.3, 0.8) + 0.25 * (2 - rise)), ((0, 1, 0), rise))
        scene.mesh("leaf").tube(base, end, 0.008, 4, caps=False)
        plants.fan_leaf(scene.mesh("leaf"), random, base, end, 0.75)


def _landscape(scene, random):
    """Grass along the lattice, a garden wall, and hills far away."""
    for _ in range(60):
        foot = (random.uniform(-1, LENGTH + 6), -0.2, WIDTH + random.uniform(0.8, 2.2))
        plants.tuft(scene.mesh("grass"), random, foot, 22, 1.3, 0.5, 0.014, radius=0.2)
    wall = scene.mesh("plaster_warm")
    wall.box((LENGTH + 12, -0.2, -8), (LENGTH + 12.3, 1.7, WIDTH + 14))
    wall.box((-10, -0.2, WIDTH + 14), (LENGTH + 12.3, 1.7, WIDTH + 14.3))
    for k in range(34):  # cypresses behind the garden's walls
        x, z = (LENGTH + 14, -6 + 2.1 * k) if k < 15 else (LENGTH + 12 - 2.3 * (k - 15), WIDTH + 16)
        height = random.uniform(4.0, 7.5)
        radius = random.uniform(0.55, 0.8)
        shape = ((0.5, 0), (0.95, 0.12), (1, 0.3), (0.8, 0.6), (0.42, 0.87), (0, 1))
        profile = [(radius * r, height * h) for r, h in shape]
        foot = (x + random.uniform(-0.5, 0.5), -0.2, z + random.uniform(-0.5, 0.5))
        scene.mesh("hedge").lathe(profile, foot, 14)

