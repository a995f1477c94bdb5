"""A scene as plain data: what the writers in files.py write and the other modules put together."""

from generator.mesh import Mesh
from generator.vectors import add, turned_about_y


class Scene:
    """Everything is added in coordinates of the building or the thing itself, and turned by `turn` degrees about the
    y axis and moved by `move` (in that order) when it is written."""

    def __init__(self, name, description, turn=0.0, move=(0, 0, 0)):
        self.name = name
        self.description = description
        self.turn = turn
        self.move = move
        self.camera = {}
        self.settings = {}
        self.materials = {}  # name: {"type": ..., ...}
        self.meshes = {}  # name of the material: Mesh
        self.shapes = []  # (comment, dictionary with keys of a YAML scene)

    def material(self, name, type, **keys):
        self.materials[name] = {"type": type, **keys}

    def mesh(self, material):
        """The mesh of a material, made at the first call."""
        if material not in self.materials:
            raise KeyError(f"no material {material!r}")
        return self.meshes.setdefault(material, Mesh())

    def sphere(self, material, center, radius, comment="", **keys):
        shape = {"type": "sphere", "material": material, "center": self.world(center), "radius": radius}
        self._add_shape(comment, shape, keys)

    def rectangle(self, material, corner, u, v, comment="", **keys):
        shape = {"type": "rectangle", "material": material, "corner": self.world(corner)}
        shape.update(u=self.turned(u), v=self.turned(v))
        self._add_shape(comment, shape, keys)

    def look(self, eye, look_at, fov):
        self.camera = {"position": self.world(eye), "look_at": self.world(look_at), "up": (0, 1, 0), "fov": fov}

    def turned(self, vector):
        return turned_about_y(vector, self.turn)

    def world(self, point):
        return add(self.turned(point), self.move)

    def triangle_count(self):
        return sum(mesh.triangle_count() for mesh in self.meshes.values())

    def _add_shape(self, comment, shape, keys):
        if shape["material"] not in self.materials:
            raise KeyError(f"no material {shape['material']!r}")
        self.shapes.append((comment, {**shape, **keys}))
