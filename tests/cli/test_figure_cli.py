"""kerf figure as a user meets it. KERF names the program."""

import json
import os
import signal
import struct
import subprocess
import time
import xml.etree.ElementTree

import pytest

KERF = os.environ["KERF"]

SQUARE = """ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
0.5 0.5 1
4 0 1 2 3
3 0 1 4
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.ply").write_text(SQUARE)
    return tmp_path


def kerf(*arguments, **options):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, timeout=120, **options)


def png_size(path):
    data = open(path, "rb").read(24)
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


def test_help_has_an_example_and_all_kinds():
    text = kerf("figure", "--help").stdout
    assert "Example" in text and all(kind in text for kind in ["heat", "levels", "leaves", "wireframe"])


def test_heat_is_side_by_side_and_says_what_rays_cost():
    result = kerf("figure", "heat", "square.ply", "--rows", "binned_sah,brute_force", "--size", "60x40", "-o", "h.png",
                  "--json", "-", "--quiet")
    assert result.returncode == 0 and result.stderr == "", result.stderr
    rows = json.loads(result.stdout)["scenes"][0]["rows"]
    assert [row["row"] for row in rows] == ["binned_sah", "brute_force"]
    assert rows[1]["triangles_per_ray"] == 3
    width, height = png_size("h.png")
    assert width > 2 * 60 and height > 2 * 40


def test_figures_do_not_depend_on_threads(folder):
    for kind in ["heat", "leaves", "wireframe"]:
        more = ["--rows", "binned_sah"]
        for threads in ["1", "3"]:
            result = kerf("figure", kind, "square.ply", *more, "--size", "50x40", "-o", threads + ".png", "--threads",
                          threads)
            assert result.returncode == 0, result.stderr
        assert (folder / "1.png").read_bytes() == (folder / "3.png").read_bytes(), kind


def test_levels_are_vectors_too():
    rows = "binned_sah(leaf=1),early_split(sa_max=8)+binned_sah(leaf=1)"
    result = kerf("figure", "levels", "--rows", rows, "--levels", "3", "-o", "l.svg")
    assert result.returncode == 0 and "l.svg written" in result.stderr, result.stderr
    root = xml.etree.ElementTree.parse("l.svg").getroot()
    space = "{http://www.w3.org/2000/svg}"
    boxes = {g.get("id"): len(g.findall(space + "rect")) for g in root.findall(space + "g")}
    assert boxes["row0-input"] == 2 and boxes["row1-input"] == 8
    assert [boxes[f"row1-level{i}"] for i in range(3)] == [1, 2, 4] and "row1-level3" not in boxes
    assert kerf("figure", "levels", "--rows", rows, "-o", "l.png").returncode == 0
    assert png_size("l.png")[0] > 1000


def test_several_wireframes_stand_side_by_side():
    result = kerf("figure", "wireframe", "square.ply", "square.ply", "--size", "50x40")
    assert result.returncode == 0, result.stderr
    assert 100 < png_size("wireframe.png")[0] < 110 and png_size("wireframe.png")[1] > 40
    assert kerf("figure", "wireframe", "square.ply", "--size", "50x40").returncode == 0
    assert png_size("wireframe.png") == (50, 40)


USAGE = [
    (["figure"], "kind"),
    (["figure", "heatt", "square.ply"], "did you mean 'heat'?"),
    (["figure", "heat"], "needs a scene"),
    (["figure", "heat", "square.ply", "--rows", "binned_shah"], "did you mean 'binned_sah'?"),
    (["figure", "heat", "square.ply", "--row", "binned_sah"], "did you mean '--rows'?"),
    (["figure", "heat", "square.ply", "--rows", "binned_sah", "--levels", "3"], "--levels"),
    (["figure", "heat", "square.ply", "--rows", "binned_sah", "--boxes", "3"], "--boxes"),
    (["figure", "heat", "square.ply", "-o", "heat.svg"], ".png"),
    (["figure", "heat", "square.ply", "--size", "9"], "WIDTHxHEIGHT"),
    (["figure", "wireframe", "square.ply", "--rows", "binned_sah,sweep_sah"], "--rows"),
    (["figure", "levels", "--rows", "binned_sah", "--levels", "0"], "--levels"),
]


@pytest.mark.parametrize("arguments, message", USAGE, ids=lambda v: " ".join(v) if isinstance(v, list) else "")
def test_wrong_usage_ends_with_2_and_writes_nothing(folder, arguments, message):
    result = kerf(*arguments)
    assert result.returncode == 2 and message in result.stderr, result.stderr
    assert os.listdir(folder) == ["square.ply"]


@pytest.mark.parametrize("output", ["a.gif", "nowhere/a.png", "."])
def test_output_that_cannot_be_written_ends_with_1(folder, output):
    result = kerf("figure", "heat", "square.ply", "--rows", "binned_sah", "-o", output)
    assert result.returncode == 1 and output in result.stderr
    assert os.listdir(folder) == ["square.ply"]


def test_bad_input_ends_with_1(folder):
    result = kerf("figure", "wireframe", "nowhere.ply")
    assert result.returncode == 1 and "nowhere.ply" in result.stderr


def test_interrupted_it_writes_nothing(folder):
    process = subprocess.Popen([KERF, "figure", "wireframe", "square.ply", "--size", "8000x8000", "--threads", "1"],
                               stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert "not written" in said and os.listdir(folder) == ["square.ply"]
