"""The scenes of the folder scenes/: that they are what their script makes, load, show something and show what splitting
does. KERF names the program."""

import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys

import pytest

KERF = os.environ["KERF"]
FOLDER = pathlib.Path(__file__).resolve().parent.parent / "scenes"
SCENES = sorted(FOLDER.glob("*.yaml"))
GENERATED = ["bicycle", "pavilion"]


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=300)


def generate(*arguments):
    return run(sys.executable, FOLDER / "generate.py", *arguments)


def test_the_files_are_what_the_script_makes():
    result = generate("all", "--check")
    assert result.returncode == 0, result.stderr


def test_check_names_a_file_that_differs_and_one_that_is_missing(tmp_path):
    assert generate("bicycle", "--output", tmp_path).returncode == 0
    assert generate("bicycle", "--output", tmp_path, "--check").returncode == 0
    with open(tmp_path / "models" / "bicycle_paint.obj", "a") as file:
        file.write("# changed\n")
    (tmp_path / "models" / "bicycle_tan.obj").unlink()
    result = generate("bicycle", "--output", tmp_path, "--check")
    assert result.returncode == 1
    assert "bicycle_paint.obj" in result.stderr and "bicycle_tan.obj" in result.stderr
    assert "bicycle_steel.obj" not in result.stderr


def test_help_has_an_example():
    result = generate("--help")
    assert result.returncode == 0 and "Example: python3 scenes/generate.py" in result.stdout


def test_ply_holds_the_triangles_of_the_models(tmp_path):
    result = generate("bicycle", "--output", tmp_path, "--ply", tmp_path / "bicycle.ply")
    assert result.returncode == 0, result.stderr
    count = int(re.search(r"element face (\d+)", (tmp_path / "bicycle.ply").read_bytes()[:400].decode("latin-1"))[1])
    faces = 0
    for path in (tmp_path / "models").iterdir():
        faces += sum(len(line.split()) - 3 for line in path.read_text().splitlines() if line.startswith("f "))
    assert count == faces > 10000


def test_every_model_belongs_to_a_scene_and_all_are_small():
    named = {name for scene in SCENES for name in re.findall(r"file: (models/[\w.]+)", scene.read_text())}
    models = list((FOLDER / "models").iterdir())
    assert {f"models/{path.name}" for path in models} == named
    assert sum(path.stat().st_size for path in models) < 3e6


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_scene_is_good_and_shows_something(scene, tmp_path):
    result = run(KERF, "check", scene)
    assert result.returncode == 0 and "(0 without area)" in result.stdout, result.stdout + result.stderr
    picture = tmp_path / "picture.pfm"
    result = run(KERF, "render", scene, "-o", picture, "--size", "36x24", "--spp", "4", "--quiet")
    assert result.returncode == 0, result.stderr
    values = struct.unpack(f"<{36 * 24 * 3}f", picture.read_bytes()[-36 * 24 * 3 * 4:])
    ordered = sorted(values)
    assert all(value >= 0 for value in values)
    assert 0.05 < sum(min(value, 1.0) for value in values) / len(values) < 0.8, "neither dark nor burnt out"
    assert ordered[len(ordered) * 9 // 10] - ordered[len(ordered) // 10] > 0.1, "contrast"


@pytest.mark.parametrize("name, least", [("pavilion", 3.0), ("bicycle", 1.5)])
def test_splitting_saves_work(name, least, tmp_path):
    """Counts, which are the same on every machine, of primary and diffuse rays together."""
    result = run(KERF, "render", FOLDER / f"{name}.yaml", "-o", tmp_path / "picture.png", "--size", "48x32", "--spp", "1",
                 "--quiet", "--compare", "binned_sah", "--json", "-")
    assert result.returncode == 0, result.stderr
    plain, split = json.loads(result.stdout)["comparison"]
    assert plain["structure"] == "binned_sah" and "early_split" in split["structure"]
    work = [entry["nodes_per_ray"] + entry["triangles_per_ray"] for entry in (plain, split)]
    assert work[0] > least * work[1], work


def test_scenes_that_need_no_models_have_none():
    for scene in SCENES:
        assert ("type: obj" in scene.read_text()) == (scene.stem in GENERATED)


def test_a_scene_works_from_another_folder(tmp_path):
    shutil.copytree(FOLDER, tmp_path / "scenes", ignore=shutil.ignore_patterns("generator", "__pycache__"))
    result = subprocess.run([KERF, "check", "scenes/bicycle.yaml"], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
