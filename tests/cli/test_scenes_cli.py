"""Scenes and models on the command line: what is drawn, and what each kind of mistake gets for an answer. KERF names the
program."""

import os
import struct
import subprocess
import sys
import zlib

import pytest

KERF = os.environ["KERF"]
QUICK = ["--size", "24x16", "--spp", "2"]

SCENE = """camera:
  position: [0, 2, 6]
  look_at: [0, 0.7, 0]
  fov: 40
settings:
  background_color: [0.3, 0.4, 0.5]
materials:
  - name: floor
    type: lambertian
    albedo: [0.7, 0.6, 0.5]
  - {name: ball, type: glass}
  - {name: lamp, type: light, color: [1, 0.9, 0.8], emission_intensity: 8}
geometry:
  - type: rectangle
    material: floor
    corner: [-5, 0, -5]
    u: [0, 0, 10]
    v: [10, 0, 0]
  - {type: sphere, material: ball, center: [-0.8, 0.7, 0], radius: 0.7}
  - {type: obj, file: square.obj, position: [0, 0, -1], scale: 2, material: floor}
  - {type: rectangle, material: lamp, corner: [-1, 4, -1], u: [2, 0, 0], v: [0, 0, 2], visible: false}
"""
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    (tmp_path / "square.obj").write_text(OBJ)
    return tmp_path


def kerf(*arguments, **options):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, errors="replace", timeout=120,
                          **options)


def write(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return name


def binary_stl():
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]
    triangles = b"".join(struct.pack("<12fH", 0, 0, 1, *sum(c, ()), 0) for c in corners)
    return bytes(80) + struct.pack("<I", 2) + triangles


ASCII_STL = """solid square
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 1 1 0
endloop
endfacet
endsolid square
"""


def glb():
    positions = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    text = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
            '"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],'
            '"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},'
            '{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],'
            '"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],'
            '"buffers":[{"byteLength":60}]}').encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", 60) + b"BIN\0" + positions + indices
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def png_pixels(path):
    """The rows of an 8-bit RGB PNG."""
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", data, at + 8)
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, rows, before = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        line = bytearray(raw[y * (3 * width + 1):(y + 1) * (3 * width + 1)])
        how, line = line[0], line[1:]
        for i in range(3 * width):
            a, b, c = (line[i - 3] if i >= 3 else 0), before[i], (before[i - 3] if i >= 3 else 0)
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, nearest)[how]) & 255
        rows.append(bytes(line))
        before = rows[-1]
    return rows


def has_format(extension):
    return f" {extension}" in kerf("list").stdout


MODELS = {"square.obj": OBJ, "square.stl": binary_stl(), "words.stl": ASCII_STL, "square.glb": glb()}


@pytest.mark.parametrize("name", MODELS)
def test_a_bare_model_gets_camera_light_and_sky(name):
    if not has_format(os.path.splitext(name)[1]):
        pytest.skip("this build does not read " + name)
    write(name, MODELS[name])
    result = kerf("render", name, "-o", "out.png", *QUICK)
    assert result.returncode == 0, result.stderr
    assert "out.png written in" in result.stderr
    rows = png_pixels("out.png")
    colours = {row[i:i + 3] for row in rows for i in range(0, len(row), 3)}
    assert rows[0][:3] == rows[0][-3:] == rows[-1][:3], "the sky is around it"
    assert len(colours) > 10, "and the model in its middle is lit"
    middle = rows[8][36:39]
    assert max(middle) > 60


def test_a_scene_shows_what_it_says_and_names_its_output(folder):
    (folder / "elsewhere").mkdir()
    result = kerf("render", "../scene.yaml", *QUICK, cwd="elsewhere")
    assert result.returncode == 0, result.stderr
    rows = png_pixels("elsewhere/scene.png")
    # sRGB of the linear background, up in the corner
    assert tuple(rows[0][:3]) == tuple(round(255 * (1.055 * x ** (1 / 2.4) - 0.055)) for x in (0.3, 0.4, 0.5))
    assert kerf("check", "scene.yaml").returncode == 0


def test_a_scene_without_geometry_shows_the_sky():
    write("sky.yaml", "settings: {background_color: [1, 1, 1], background_intensity: 1}\n")
    assert kerf("render", "sky.yaml", *QUICK).returncode == 0
    assert {byte for row in png_pixels("sky.png") for byte in row} == {255}
    write("empty.yaml", "")
    assert kerf("render", "empty.yaml", *QUICK).returncode == 0
    assert tuple(png_pixels("empty.png")[3][:3]) == (188, 218, 255), "the default sky, 0.5 0.7 1.0"


@pytest.mark.parametrize("extension, magic", [("png", b"\x89PNG"), ("pfm", b"PF\n"), ("exr", b"\x76\x2f\x31\x01")])
def test_every_picture_format_is_written(extension, magic):
    result = kerf("render", "scene.yaml", "-o", f"out.{extension}", *QUICK)
    if "OpenEXR" in result.stderr:
        pytest.skip("this build writes no EXR")
    assert result.returncode == 0, result.stderr
    assert open(f"out.{extension}", "rb").read(4).startswith(magic)


def test_exposure_brightens_a_png():
    write("sky.yaml", "settings: {background_color: [0.1, 0.2, 0.3]}\n")
    assert kerf("render", "sky.yaml", "--exposure", "1", *QUICK).returncode == 0
    assert tuple(png_pixels("sky.png")[0][:3]) == tuple(round(255 * (1.055 * x ** (1 / 2.4) - 0.055)) for x in (0.2, 0.4, 0.6))
    assert kerf("render", "sky.yaml", "--exposure", "-0.5", *QUICK).returncode == 0
    assert png_pixels("sky.png")[0][2] == round(255 * (1.055 * (0.3 * 0.5 ** 0.5) ** (1 / 2.4) - 0.055))


def test_use_bvh_false_is_brute_force_and_the_same_picture(folder):
    assert kerf("render", "scene.yaml", "-o", "a.pfm", *QUICK).returncode == 0
    write("plain.yaml", SCENE.replace("settings:\n", "settings:\n  use_bvh: false\n"))
    result = kerf("render", "plain.yaml", "-o", "b.pfm", "--json", "figures.json", *QUICK)
    assert result.returncode == 0, result.stderr
    assert '"structure": "brute_force"' in (folder / "figures.json").read_text()
    assert (folder / "a.pfm").read_bytes() == (folder / "b.pfm").read_bytes()


def test_adaptive_sampling_is_accepted_with_one_line():
    write("scene.yaml", SCENE.replace("settings:\n", "settings:\n  adaptive_sampling: true\n"))
    result = kerf("render", "scene.yaml", *QUICK)
    assert result.returncode == 0 and result.stderr.count("equal samples") == 1


# What is replaced in the scene, by what, where the error is, and what it says.
MISTAKES = {
    "misspelt key": ("look_at:", "lok_at:", "scene.yaml:3:3", "did you mean 'look_at'?"),
    "misspelt section": ("geometry:", "geomtry:", "scene.yaml:13:1", "did you mean 'geometry'?"),
    "misspelt material type": ("lambertian", "lambertain", "scene.yaml:9:11", "did you mean 'lambertian'?"),
    "misspelt shape": ("type: sphere", "type: sfere", "scene.yaml:19:12", "did you mean 'sphere'?"),
    "missing material": ("material: ball", "material: bal", "scene.yaml:19:30", "did you mean 'ball'?"),
    "no material": ("material: ball, ", "", "scene.yaml:19", "material"),
    "duplicate key": ("  fov: 40", "  fov: 40\n  fov: 50", "scene.yaml:5:3", "fov"),
    "duplicate material": ("name: ball", "name: floor", "scene.yaml:11:", "floor"),
    "merge key": ("- {name: ball, ", "- {<<: {}, name: ball, ", "scene.yaml:11", "<<"),
    "syntax error": ("[0, 2, 6]", "[0, 2, 6", "scene.yaml:", ""),
    "wrong type": ("fov: 40", "fov: wide", "scene.yaml:4:8", "number"),
    "text for a vector": ("position: [0, 2, 6]", "position: 5", "scene.yaml:2:13", "three numbers"),
    "two numbers for three": ("[0, 2, 6]", "[0, 2]", "scene.yaml:2:13", "three numbers"),
    "not finite": ("[0, 2, 6]", "[0, .nan, 6]", "scene.yaml:2:", ""),
    "field of view out of range": ("fov: 40", "fov: 180", "scene.yaml:4:8", "180"),
    "negative radius": ("radius: 0.7", "radius: -0.7", "scene.yaml:19:", "radius"),
    "albedo above 1": ("[0.7, 0.6, 0.5]", "[0.7, 1.6, 0.5]", "scene.yaml:10:", "albedo"),
    "not a boolean": ("visible: false", "visible: no", "scene.yaml:21:", "false"),
    "not there yet": ("type: lambertian", "type: thin_film", "scene.yaml:9:", "not there yet"),
    "pattern": ("type: lambertian", "type: lambertian\n    pattern: {type: stripes}", "scene.yaml:10:", "not there yet"),
    "displaced sphere": ("type: sphere", "type: displaced_sphere", "scene.yaml:19:", "not there yet"),
    "missing file": ("square.obj", "sqare.obj", "scene.yaml:20:", "sqare.obj"),
    "a folder as file": ("square.obj", "../" + "x.obj", "scene.yaml:20:", "x.obj"),
    "misspelt structure": ("settings:\n", "settings:\n  structure: binned_shah\n", "scene.yaml:6:14", "did you mean 'binned_sah'?"),
    "structure with a bad option": ("settings:\n", "settings:\n  structure: binned_sah(bin=3)\n", "scene.yaml:6:14", "did you mean 'bins'?"),
    "use_bvh and structure": ("settings:\n", "settings:\n  use_bvh: false\n  structure: binned_sah\n", "scene.yaml:", "use_bvh"),
    "top level is a list": (SCENE, "- a\n- b\n", "scene.yaml:1:1", "list"),
    "two documents": ("camera:", "--- {}\n---\ncamera:", "scene.yaml:", "document"),
}


@pytest.mark.parametrize("kind", MISTAKES)
def test_a_mistake_in_a_scene_is_named_with_its_place(folder, kind):
    old, new, place, words = MISTAKES[kind]
    assert old in SCENE
    (folder.parent / "x.obj").mkdir(exist_ok=True)
    write("scene.yaml", SCENE.replace(old, new, 1))
    for command in (["check", "scene.yaml"], ["render", "scene.yaml", *QUICK]):
        result = kerf(*command)
        assert result.returncode == 1, result.stderr
        assert result.stderr.startswith("kerf: ") and result.stderr.count("\n") == 1, result.stderr
        assert place in result.stderr and words in result.stderr, result.stderr
        assert sorted(os.listdir(folder)) == ["scene.yaml", "square.obj"]


BAD_FILES = {
    "truncated obj": ("a.obj", OBJ[:-4], "a.obj:5"),
    "obj with a bad index": ("a.obj", OBJ + "f 1 2 9\n", "a.obj:6"),
    "obj with a misspelt keyword": ("a.obj", OBJ + "fase 1 2 3\n", "a.obj:6"),
    "obj without a face": ("a.obj", "v 0 0 0\n", "no face"),
    "truncated stl": ("a.stl", binary_stl()[:-30], "a.stl"),
    "truncated ascii stl": ("a.stl", ASCII_STL[:60], "a.stl:"),
    "truncated glb": ("a.glb", glb()[:-30], "a.glb"),
    "glb with a wrong length": ("a.glb", glb()[:8] + struct.pack("<I", len(glb()) + 4) + glb()[12:], "a.glb"),
    "glb that is json": ("a.glb", "{}", "a.glb"),
    "gltf with a syntax error": ("a.gltf", '{"asset": ', "a.gltf"),
    "no end of name": ("a", OBJ, "a: "),
    "misspelt end of name": ("a.glt", glb(), "did you mean"),
    "yaml of random bytes": ("a.yaml", bytes(range(256)), "a.yaml"),
    "obj of random bytes": ("a.obj", bytes(range(256)), "a.obj"),
    "stl of random bytes": ("a.stl", bytes(range(256)), "a.stl"),
    "glb of random bytes": ("a.glb", bytes(range(256)), "a.glb"),
}


@pytest.mark.parametrize("kind", BAD_FILES)
def test_a_bad_file_is_named_and_nothing_is_written(folder, kind):
    name, content, words = BAD_FILES[kind]
    write(name, content)
    before = sorted(os.listdir(folder))
    result = kerf("render", name, "-o", "out.png", *QUICK)
    assert result.returncode == 1, result.stderr
    assert result.stderr.startswith("kerf: ") and words in result.stderr, result.stderr
    assert sorted(os.listdir(folder)) == before


@pytest.mark.parametrize("name", ["nowhere.yaml", "nowhere.obj", "nowhere.stl", "nowhere.glb", "nowhere.gltf"])
def test_missing_files_and_folders_are_named(folder, name):
    result = kerf("render", name, *QUICK)
    assert result.returncode == 1 and name in result.stderr
    (folder / name).mkdir()
    result = kerf("render", name, *QUICK)
    assert result.returncode == 1 and name in result.stderr and "folder" in result.stderr.lower(), result.stderr


def test_an_output_folder_that_cannot_be_written_is_named(folder):
    result = kerf("render", "scene.yaml", "-o", "nowhere/out.png")
    assert result.returncode == 1 and "nowhere" in result.stderr
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere")
    (folder / "locked").mkdir(mode=0o555)
    result = kerf("render", "scene.yaml", "-o", "locked/out.png", "--spp", "100000")
    assert result.returncode == 1 and "locked" in result.stderr


def test_structure_on_the_command_line_goes_before_the_scene_and_is_judged_first():
    write("scene.yaml", SCENE.replace("settings:\n", "settings:\n  structure: sweep_sah\n"))
    result = kerf("check", "scene.yaml", "--structure", "spatial_median")
    assert "spatial_median" in result.stdout
    assert "sweep_sah" in kerf("check", "scene.yaml").stdout
    for structure, words in [("binned_shah", "did you mean 'binned_sah'?"), ("binned_sah(bin=3)", "did you mean 'bins'?")]:
        result = kerf("render", "nowhere.yaml", "--structure", structure)
        assert result.returncode == 2 and words in result.stderr


if __name__ == "__main__":
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
