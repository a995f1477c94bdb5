"""kerf make, kerf convert and scenes/get as a user meets them. KERF names the program."""

import json
import os
import pathlib
import re
import stat
import subprocess
import sys

import pytest

KERF = os.environ["KERF"]
GET = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "get"
NAMES = ["city", "mirror", "needles", "plant", "soup", "stadium"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120, **options)


def kerf(*words, **options):
    return run(KERF, *words, **options)


def faces_of(path):
    return int(re.search(rb"element face (\d+)", pathlib.Path(path).read_bytes()[:300])[1])


@pytest.mark.parametrize("name", NAMES)
def test_make_writes_a_model_that_its_camera_sees(name):
    result = kerf("make", name, "--triangles", "12000", "--json", "-", "--quiet")
    assert result.returncode == 0 and result.stderr == "", result.stderr
    figures = json.loads(result.stdout)
    assert figures["model"] == name and figures["output"] == f"{name}.ply"
    assert figures["triangles"] == faces_of(f"{name}.ply") == pytest.approx(12000, rel=0.05)
    assert set(figures["camera"]) == {"eye", "look_at", "up", "fov"}
    seen = kerf("render", f"{name}.ply", *figures["camera_options"].split(), "--view", "depth", "-o", "d.pfm", "--size",
                "24x16", "--json", "-", "--quiet")
    assert seen.returncode == 0, seen.stderr
    shown = json.loads(seen.stdout)
    assert shown["hits"] > 0.05 * shown["rays"]


def test_make_repeats_and_says_how_to_look():
    for output, seed in [("a.ply", 1), ("b.ply", 1), ("c.ply", 2)]:
        result = kerf("make", "plant", "--triangles", "5000", "--seed", seed, "-o", output, "--threads", "2")
        assert result.returncode == 0 and result.stdout == ""
        assert f"{output} written" in result.stderr and f"kerf render {output} --eye " in result.stderr
    a, b, c = (pathlib.Path(name).read_bytes() for name in ("a.ply", "b.ply", "c.ply"))
    assert a == b != c


def test_list_and_help_name_the_models():
    menu = json.loads(kerf("list", "--json", "-").stdout)
    assert [entry["name"] for entry in menu if entry["kind"] == "model"] == NAMES
    for text in (kerf("list").stdout, kerf("make", "--help").stdout):
        assert all(re.search(rf"^  {name} ", text, re.M) for name in NAMES)


@pytest.mark.parametrize("words, message", [
    (["make"], "name"),
    (["make", "plnt"], "did you mean 'plant'?"),
    (["make", "plant", "--triangle", "5"], "did you mean '--triangles'?"),
    (["make", "plant", "--triangles", "0"], "--triangles"),
    (["make", "plant", "--triangles", "2147483648"], "--triangles"),
    (["make", "plant", "--triangles", "many"], "--triangles"),
    (["make", "plant", "--seed", "-1"], "--seed"),
    (["make", "plant", "-o", "plant.obj"], ".ply"),
    (["convert", "a.ply"], "output"),
    (["convert", "a.ply", "b.obj"], ".ply"),
    (["convert", "a.ply", "b.ply", "--quite"], "did you mean '--quiet'?"),
])
def test_wrong_usage_ends_with_2_and_writes_nothing(folder, words, message):
    result = kerf(*words)
    assert result.returncode == 2 and message in result.stderr and result.stdout == "", result.stderr
    assert os.listdir(folder) == []


def test_a_file_that_cannot_be_written_is_told_first(folder):
    for words in (["make", "soup", "-o", "none/soup.ply"], ["convert", "missing.obj", "none/a.ply"]):
        result = kerf(*words)
        assert result.returncode == 1 and "there is no folder none" in result.stderr
    assert os.listdir(folder) == []


def test_convert_keeps_triangles_and_refuses_what_it_cannot_read(folder):
    pathlib.Path("roof.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1 2 3 4\nf 1 3 2\n")
    result = kerf("convert", "roof.obj", "roof.ply", "--json", "-")
    assert result.returncode == 0 and "roof.ply written: 3 triangles" in result.stderr
    assert json.loads(result.stdout)["vertices"] == 4
    assert kerf("convert", "roof.ply", "again.ply", "--quiet").returncode == 0
    assert pathlib.Path("again.ply").read_bytes() == pathlib.Path("roof.ply").read_bytes()
    pathlib.Path("bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    result = kerf("convert", "bad.obj", "bad.ply")
    assert result.returncode == 1 and "bad.obj:2" in result.stderr and not os.path.exists("bad.ply")


def get(*words, **environment):
    return run(sys.executable, GET, *words, env={**os.environ, **environment})


def test_get_lists_and_explains():
    listed = get("--list")
    assert listed.returncode == 0 and "dragon" in listed.stdout and "glmark2-data" in listed.stdout
    assert "Example: scenes/get" in get("--help").stdout
    wrong = get("buny")
    assert wrong.returncode == 2 and "did you mean 'bunny'?" in wrong.stderr
    assert get().returncode == 2


def test_get_says_what_to_install_and_goes_on(tmp_path):
    """With a copy that looks for its files where there are none."""
    text = GET.read_text().replace("/usr/share/", str(tmp_path / "none") + "/")
    copy = tmp_path / "get"
    copy.write_text(text)
    tools = tmp_path / "tools"
    tools.mkdir()
    fake = tools / "apt-get"
    fake.write_text("#!/bin/sh\nexit 9\n")
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    result = run(sys.executable, copy, "bunny", "housing_fine", "dragon", "--output", tmp_path / "out", "--kerf", KERF,
                 env={"PATH": str(tools)})
    assert result.returncode == 1 and result.stdout == ""
    assert "apt-get install glmark2-data" in result.stderr and "--yes" in result.stderr
    assert "apt-get install occt-misc occt-draw libocct-draw-dev" in result.stderr
    assert "apt-get install npm" in result.stderr
    assert os.listdir(tmp_path / "out") == []
    gone = get("bunny", "--kerf", tmp_path / "kerf")
    assert gone.returncode == 1 and "there is no program" in gone.stderr


def test_get_converts_and_adds_cameras(tmp_path):
    """With a copy that takes the bunny from here."""
    pathlib.Path("bunny.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    copy = tmp_path / "get"
    copy.write_text(GET.read_text().replace("/usr/share/glmark2/models/bunny.obj", str(tmp_path / "bunny.obj")))
    out = tmp_path / "out"
    out.mkdir()
    head = "scene\tcamera\teye_x\teye_y\teye_z\tat_x\tat_y\tat_z\tup_x\tup_y\tup_z\tvfov_deg\n"
    other = "abbey\t1" + "\t1" * 10 + "\n"
    (out / "cameras.tsv").write_text(head + "bunny\t9" + "\t0" * 10 + "\n" + other)
    for _ in range(2):
        result = run(sys.executable, copy, "bunny", "--output", out, "--kerf", KERF)
        assert result.returncode == 0 and "1 triangles" in result.stdout
        assert "had 69666 triangles" in result.stderr, "another version of the package"
        lines = (out / "cameras.tsv").read_text().splitlines(keepends=True)
        assert lines[0] == head and lines[1] == other and [line[:7] for line in lines[2:]] == ["bunny\t1", "bunny\t2"]
        assert all(line.count("\t") == 11 for line in lines)
    assert faces_of(out / "bunny.ply") == 1
    assert sorted(os.listdir(out)) == ["bunny.ply", "cameras.tsv"]
