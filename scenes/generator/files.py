"""Writes a scene: a YAML file, an OBJ file for each material that has a mesh, and PLY to measure with."""

import re
import struct
import textwrap

DIGITS = 4  # of coordinates, after the point


def files_of(scene):
    """All files of a scene as {path relative to the folder of the scenes: text}."""
    files = {f"{scene.name}.yaml": yaml_text(scene)}
    for material in scene.meshes:
        files[model_path(scene, material)] = obj_text(scene, material)
    return files


def model_path(scene, material):
    return f"models/{scene.name}_{material}.obj"


def number(value, digits=DIGITS):
    """A number without needless zeros, never as -0."""
    text = f"{value:.{digits}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def vector(values, digits=DIGITS):
    return " ".join(number(value, digits) for value in values)


def obj_text(scene, material):
    """Faces follow the vertices of their part and count them from the end, which keeps the file short."""
    mesh = scene.meshes[material]
    lines = [f"# {scene.name}: {material}, {mesh.triangle_count()} triangles. Made by scenes/generate.py."]
    for vertices, faces, normals in mesh.parts:
        n = len(vertices)
        lines += ["v " + vector(scene.world(p)) for p in vertices]
        if normals:
            lines += ["vn " + vector(scene.turned(p), 2) for p in normals]
            lines += ["f " + " ".join(f"{i - n}//{i - n}" for i in face) for face in faces]
        else:
            lines += ["f " + " ".join(str(i - n) for i in face) for face in faces]
    return "\n".join(lines) + "\n"


def ply_bytes(scene):
    """All meshes of a scene as one binary PLY, for programs that want nothing but triangles."""
    vertices, triangles = [], []
    for mesh in scene.meshes.values():
        for points, faces, _ in mesh.parts:
            first = len(vertices)
            vertices += [[float(number(x)) for x in scene.world(p)] for p in points]
            triangles += [[first + face[0], first + b, first + c] for face in faces for b, c in zip(face[1:], face[2:])]
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack("<3f", *p) for p in vertices)
    return header.encode() + body + b"".join(struct.pack("<B3i", 3, *t) for t in triangles)


def yaml_text(scene):
    lines = [f"# {line}" for line in textwrap.wrap(scene.description, 118)]
    lines += ["#", f"# Made by: python3 scenes/generate.py {scene.name}", ""]
    lines += ["camera:"] + [f"  {key}: {_value(value)}" for key, value in scene.camera.items()]
    lines += ["", "settings:"] + [f"  {key}: {_value(value)}" for key, value in scene.settings.items()]
    lines += ["", "materials:"]
    lines += [f"  - {_flow({'name': name, **keys})}" for name, keys in scene.materials.items()]
    lines += ["", "geometry:"]
    for comment, shape in scene.shapes:
        if comment:
            lines.append(f"  # {comment}")
        lines += _wrapped(f"  - {_flow(shape)}")
    for material in scene.meshes:
        lines.append(f"  - {_flow({'type': 'obj', 'material': material, 'file': model_path(scene, material)})}")
    return "\n".join(lines) + "\n"


def _wrapped(line):
    """A long line in several, vectors in one piece."""
    together = re.sub(r"\[[^]]*\]", lambda vector: vector[0].replace(" ", "\0"), line)
    pieces = textwrap.wrap(together, 120, subsequent_indent="      ", break_on_hyphens=False)
    return [piece.replace("\0", " ") for piece in pieces]


def _flow(keys):
    return "{ " + ", ".join(f"{key}: {_value(value)}" for key, value in keys.items()) + " }"


def _value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value if value.replace("_", "").replace("/", "").replace(".", "").isalnum() else f'"{value}"'
    if isinstance(value, (tuple, list)):
        return "[" + ", ".join(number(x) for x in value) + "]"
    return number(value)
