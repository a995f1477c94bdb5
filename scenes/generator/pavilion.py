"""The default picture: an atelier under a twisted timber roof."""

from random import Random

from generator import pavilion_building as building
from generator import pavilion_things as things
from generator.scene import Scene
from generator.vectors import along, unit

DESCRIPTION = (
    "An atelier under a roof of straight timbers that twist into a saddle, a lattice of crossing battens on its sunny "
    "side. Nearly everything is long, thin and, as the hall stands askew, parallel to no axis: what an ordinary "
    "bounding volume hierarchy is slow on, and splitting helps."
)


def scene():
    scene = Scene("pavilion", DESCRIPTION, turn=31, move=(-8.0, 0.0, 0.0))
    scene.settings = {
        "background_color": (0.60, 0.75, 1.0),
        "background_intensity": 1.25,
        "ambient_light": 0.0,
        "structure": "early_split(budget=2)+binned_sah",
    }
    _materials(scene)
    _light(scene)
    random = Random(7)
    building.build(scene, random)
    building.ramp(scene, random)
    building.spiral_stair(scene)
    things.furnish(scene, random)
    scene.look(eye=(-1.2, 1.6, 3.4), look_at=(12.0, 2.35, 5.4), fov=54)
    return scene


def _materials(scene):
    for name, albedo in {
        "oak": (0.46, 0.30, 0.17),
        "oak_light": (0.56, 0.40, 0.24),
        "oak_dark": (0.28, 0.18, 0.115),
        "plaster": (0.80, 0.77, 0.72),
        "plaster_warm": (0.72, 0.66, 0.58),
        "joint": (0.10, 0.10, 0.10),
        "black": (0.035, 0.035, 0.04),
        "terracotta": (0.58, 0.21, 0.11),
        "red": (0.62, 0.09, 0.05),
        "blue": (0.07, 0.15, 0.24),
        "ochre": (0.74, 0.46, 0.10),
        "paper": (0.78, 0.76, 0.70),
        "leaf": (0.13, 0.24, 0.06),
        "leaf_light": (0.24, 0.34, 0.10),
        "grass": (0.42, 0.38, 0.18),
        "hedge": (0.10, 0.15, 0.06),
        "gravel": (0.52, 0.48, 0.41),
    }.items():
        scene.material(name, "lambertian", albedo=albedo)
    scene.material("concrete", "metal", albedo=(0.46, 0.45, 0.43), roughness=0.38, metallic=0.15)
    scene.material("concrete_warm", "metal", albedo=(0.49, 0.47, 0.44), roughness=0.38, metallic=0.15)
    scene.material("steel", "metal", albedo=(0.62, 0.62, 0.63), roughness=0.45)
    scene.material("brass", "metal", albedo=(0.90, 0.66, 0.30), roughness=0.14)
    scene.material("glass", "glass", albedo=(1, 1, 1), refractive_index=1.5)
    scene.material("bulb", "constant", albedo=(4.0, 2.6, 1.4))
    scene.material("sun", "light", emission=(220000, 177000, 122000))


def _light(scene):
    """One light that is sampled, a low sun; the rest is sky, seen through the openings."""
    distance, direction = 90, unit((0.36, 0.44, 0.82))
    center = along((12, 3, 5), (direction, distance))
    scene.sphere("sun", center, 0.35, "A low sun beyond the lattice", visible=False)
    scene.rectangle("gravel", (-10, -0.2, 11.3), (46, 0, 0), (0, 0, 14), "The garden")
    scene.rectangle("gravel", (26, -0.2, -8), (10, 0, 0), (0, 0, 19.3))
