"""The command line as a user meets it: what it writes, what it says, how it ends. KERF names the program."""

import json
import os
import pathlib
import signal
import struct
import subprocess
import sys
import time

import pytest

KERF = os.environ["KERF"]

# A unit square at z = 0 as two triangles, seen from z = 2 with a field of view that it fills exactly half of.
SQUARE = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
4 0 1 2 3
"""
QUICK = ["--size", "16x12", "--spp", "2"]
CAMERA = ["--eye", "0.5,0.5,2", "--look-at", "0.5,0.5,0", "--up", "0,1,0", "--fov", "53.130102354155980"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.ply").write_text(SQUARE)
    return tmp_path


def kerf(*arguments, **options):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, timeout=120, **options)


def read_pfm(path):
    data = open(path, "rb").read()
    kind, size, scale, pixels = data.split(b"\n", 3)
    width, height = map(int, size.split())
    channels = {b"Pf": 1, b"PF": 3}[kind]
    assert float(scale) < 0, "little-endian"
    values = struct.unpack(f"<{width * height * channels}f", pixels)
    rows = [values[y * width * channels:(y + 1) * width * channels] for y in range(height)]
    return rows[::-1]  # the file starts with the bottom row


def render(view, size="8x8", *more):
    result = kerf("render", "square.ply", "-o", "out.pfm", "--view", view, "--size", size, *CAMERA, *more)
    assert result.returncode == 0, result.stderr
    assert result.stdout == ""
    return read_pfm("out.pfm")


def test_depth_is_the_length_of_the_unit_ray_and_infinite_beside_the_model():
    rows = render("depth")
    for y in range(8):
        for x in range(8):
            px, py = (x + 0.5) / 4 - 1, 1 - (y + 0.5) / 4
            inside = 2 <= x < 6 and 2 <= y < 6
            expected = 2 * (1 + px * px / 4 + py * py / 4) ** 0.5 if inside else float("inf")
            assert rows[y][x] == pytest.approx(expected, rel=1e-6), (x, y)


def test_primitive_is_the_callers_number_the_right_way_up():
    rows = render("primitive")
    assert rows[0][0] == -1
    assert rows[5][5] == 0, "below the diagonal lies triangle 0"
    assert rows[2][2] == 1, "above it triangle 1"
    assert {value for row in rows for value in row} == {-1, 0, 1}


def test_normal_uv_and_counts():
    normal = render("normal")
    assert normal[5][5 * 3:5 * 3 + 3] == (0, 0, 1)
    assert normal[0][0:3] == (0, 0, 0)
    uv = render("uv")
    assert uv[5][5 * 3:5 * 3 + 3] == pytest.approx((0.75, 0.125, 0))
    triangles = render("triangles")
    assert triangles[0][0] == 0 and triangles[4][4] == 2
    nodes = render("nodes")
    assert nodes[0][0] == 0 and nodes[4][4] == 1
    assert {v for row in render("triangles", "8x8", "--structure", "brute_force") for v in row} == {2}


@pytest.mark.parametrize("structure", ["sweep_sah", "early_split(sa_max=0.1)+binned_sah", "brute_force"])
def test_every_structure_gives_the_same_bytes_for_any_threads(structure):
    render("depth", "40x30")
    first = open("out.pfm", "rb").read()
    render("depth", "40x30", "--structure", structure, "--threads", "3")
    assert open("out.pfm", "rb").read() == first


def test_png_is_written_by_default_beside_the_caller(folder):
    (folder / "elsewhere").mkdir()
    result = kerf("render", "../square.ply", *QUICK, cwd="elsewhere")
    assert result.returncode == 0, result.stderr
    assert (folder / "elsewhere" / "square.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert "square.png" in result.stderr and result.stdout == ""
    assert kerf("render", "square.ply", *QUICK, "--quiet").stderr == ""


def test_json_says_what_was_done():
    result = kerf("render", "square.ply", "-o", "a.png", "--view", "depth", "--size", "8x8", *CAMERA, "--json", "-",
                  "--structure", "early_split(sa_max=0.6)+binned_sah", "--quiet")
    assert result.returncode == 0 and result.stderr == ""
    figures = json.loads(result.stdout)
    assert figures["rays"] == 64 and figures["hits"] == 16 and figures["complete"] is True
    scene = figures["scene"]
    assert scene["primitives"] == 2 and scene["references"] > 2 and scene["sa_max"] == 0.6
    assert scene["references_per_primitive"] == scene["references"] / 2
    assert len(scene["tree_hash"]) == 16
    assert scene["capped"] is False and scene["short_of_room"] == []
    plain = json.loads(kerf("render", "square.ply", "-o", "a.png", *QUICK, "--json", "-", "--quiet").stdout)
    assert plain["view"] == "beauty" and plain["samples"] == 2 and plain["paths"] == 16 * 12 * 2 <= plain["rays"]
    assert plain["scene"]["sa_max"] == "auto" and plain["scene"]["references"] == 4, "the square and two lights"
    assert plain["scene"]["structure"].startswith("early_split(sa_max=auto)+binned_sah+reinsertion"), "balanced"


def test_docs_name_every_structure():
    text = (pathlib.Path(__file__).parents[2] / "docs" / "structures.md").read_text()
    for entry in json.loads(kerf("list", "--json", "-").stdout):
        if entry["kind"] in ("splitter", "builder", "optimiser", "layout", "structure"):
            assert f"`{entry['name']}`" in text, entry["name"]


def test_list_names_every_entry():
    menu = json.loads(kerf("list", "--json", "-").stdout)
    names = [entry["name"] for entry in menu]
    assert {entry["kind"] for entry in menu} == {"preset", "splitter", "builder", "optimiser", "layout", "structure", "view", "material", "model", "format"}
    assert kerf("list", "--quiet", "--threads", "2").returncode == 0
    for name in ["early_split", "spatial_median", "object_median", "sweep_sah", "binned_sah", "brute_force", "beauty",
                 "glass", ".obj"]:
        assert name in names
    text = kerf("list").stdout
    assert all(name in text for name in names) and "primitive" in text


def test_help_of_every_command_has_an_example():
    for command in [[], ["render"], ["check"], ["list"], ["make"], ["convert"]]:
        result = kerf(*command, "--help")
        assert result.returncode == 0 and "Example" in result.stdout and "kerf " in result.stdout
    assert kerf("--version").stdout.startswith("kerf 0.")
    assert kerf().returncode == 0


USAGE = [
    (["rendr", "square.ply"], "did you mean 'render'?"),
    (["render"], "input"),
    (["render", "square.ply", "--veiw", "depth"], "did you mean '--view'?"),
    (["render", "square.ply", "--view", "dept"], "did you mean 'depth'?"),
    (["render", "square.ply", "--structure", "binned_shah"], "did you mean 'binned_sah'?"),
    (["render", "square.ply", "--structure", "binned_sah(bin=8)"], "did you mean 'bins'?"),
    (["render", "square.ply", "--structure", "binned_sah(bins=0)"], "at least 2"),
    (["render", "square.ply", "--structure", "early_split(sa_max=0)+binned_sah"], "above 0"),
    (["render", "square.ply", "--size", "10"], "WIDTHxHEIGHT"),
    (["render", "square.ply", "--size", "0x10"], "WIDTHxHEIGHT"),
    (["render", "square.ply", "--size", "10x-3"], "WIDTHxHEIGHT"),
    (["render", "square.ply", "--eye", "1,2"], "--eye"),
    (["render", "square.ply", "--eye", "1,2,x"], "--eye"),
    (["render", "square.ply", "--eye", "1,2,3,4"], "X,Y,Z"),
    (["render", "square.ply", "--eye", "1,inf,3"], "X,Y,Z"),
    (["render", "square.ply", "--fov", "0"], "--fov"),
    (["render", "square.ply", "--size", "4294967297x4"], "WIDTHxHEIGHT"),
    (["render", "square.ply", "--size", "8x8x8"], "WIDTHxHEIGHT"),
    (["render", "square.ply", "--size", "65536x2731"], "too many for a PNG"),
    (["render", "square.ply", "--exposure", "nan"], "--exposure"),
    (["render", "square.ply", "-o", "a.pfm", "--exposure", "1"], "--exposure"),
    (["render", "square.ply", "--view", "depth", "--exposure", "1"], "--exposure"),
    (["render", "square.ply", "--view", "depth", "--spp", "4"], "--spp"),
    (["render", "square.ply", "--view", "depth", "--seed", "4"], "--seed"),
    (["render", "square.ply", "--fov", "180"], "--fov"),
    (["render", "square.ply", "--eye", "1,1,1", "--look-at", "1,1,1"], "eye and look-at"),
    (["render", "square.ply", "--up", "0,0,0"], "camera"),
    (["render", "square.ply", "--threads", "-1"], "--threads"),
    (["render", "square.ply", "--spp", "0"], "--spp"),
    (["render", "square.ply", "--spp", "many"], "--spp"),
    (["render", "square.ply", "--seed", "-1"], "--seed"),
    (["render", "square.ply", "--compare", "binned_sh"], "did you mean 'binned_sah'?"),
    (["chek", "square.ply"], "did you mean 'check'?"),
    (["check", "square.ply", "--spp", "4"], "--spp"),
]


@pytest.mark.parametrize("arguments, message", USAGE, ids=lambda value: " ".join(value) if isinstance(value, list) else "")
def test_wrong_usage_ends_with_2_and_writes_nothing(folder, arguments, message):
    before = sorted(os.listdir(folder))
    result = kerf(*arguments)
    assert result.returncode == 2, result.stderr
    assert message in result.stderr and result.stdout == ""
    assert sorted(os.listdir(folder)) == before


def broken(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return name


BAD_FILES = {
    "missing": (lambda: "nowhere.ply", "nowhere.ply"),
    "a folder": (lambda: ".", "."),
    "not a PLY": (lambda: broken("a.ply", "solid stl"), "a.ply:1"),
    "cut short": (lambda: broken("a.ply", SQUARE[:-20]), "a.ply:"),
    "lying header": (lambda: broken("a.ply", SQUARE.replace("vertex 4", "vertex 4000000000")), "a.ply"),
    "bad index": (lambda: broken("a.ply", SQUARE.replace("4 0 1 2 3", "4 0 1 2 4")), "a.ply:14"),
    "not finite": (lambda: broken("a.ply", SQUARE.replace("1 1 0\n", "1 nan 0\n")), "triangle 0"),
    "no faces": (lambda: broken("a.ply", SQUARE.replace("face 1", "face 0").replace("4 0 1 2 3\n", "")), "no face"),
    "random bytes": (lambda: broken("a.ply", bytes(range(256)) * 10), "a.ply"),
}


@pytest.mark.parametrize("kind", BAD_FILES)
def test_bad_input_ends_with_1_and_writes_nothing(folder, kind):
    make, message = BAD_FILES[kind]
    path = make()
    result = kerf("render", path, "-o", "out.png")
    assert result.returncode == 1, result.stderr
    assert message in result.stderr and result.stderr.startswith("kerf: ")
    assert not (folder / "out.png").exists()


def test_skip_invalid_drops_and_says_so():
    broken("a.ply", SQUARE.replace("1 1 0\n", "1 1 nan\n").replace("face 1", "face 2").replace(
        "4 0 1 2 3", "3 0 1 2\n3 0 1 3"))
    result = kerf("render", "a.ply", "-o", "out.png", "--skip-invalid", *QUICK)
    assert result.returncode == 0 and "1 invalid triangle" in result.stderr


@pytest.mark.parametrize("output", ["nowhere/out.png", "out.gif", "."])
def test_output_that_cannot_be_written_ends_with_1(output):
    result = kerf("render", "square.ply", "-o", output)
    assert result.returncode == 1 and output in result.stderr


def wait_for_handler(process):
    """Returns when the process catches SIGINT, so that a signal does not come too early."""
    for _ in range(600):
        try:
            with open(f"/proc/{process.pid}/status") as status:
                caught = next(int(line.split()[1], 16) for line in status if line.startswith("SigCgt"))
            if caught >> (signal.SIGINT - 1) & 1:
                return
        except (OSError, StopIteration):
            time.sleep(2)
            return
        time.sleep(0.02)


def test_options_of_three_numbers_leave_the_input_alone(folder):
    result = kerf("render", *QUICK, "--eye", "0.5,0.5,2", "--look-at", "0.5,0.5,0", "square.ply")
    assert result.returncode == 0, result.stderr


def test_a_name_that_is_no_text_is_written_all_the_same(folder):
    name = b"sq\xffuare.ply"
    (folder / os.fsdecode(name)).write_text(SQUARE)
    result = subprocess.run([KERF, "render", name, "-o", "out.png", *QUICK, "--json", "-"], capture_output=True)
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["input"] == "sq\ufffduare.ply"


def test_json_that_cannot_be_written_is_known_before_any_work(folder):
    result = kerf("render", "square.ply", "-o", "out.png", "--json", "nowhere/x.json", "--spp", "1000000")
    assert result.returncode == 1 and "nowhere" in result.stderr and not (folder / "out.png").exists()
    (folder / "folder.png").mkdir()
    result = kerf("render", "square.ply", "-o", "folder.png", "--spp", "1000000")
    assert result.returncode == 1 and "it is a folder" in result.stderr


def test_a_model_at_the_edge_of_what_is_allowed_is_drawn():
    broken("a.ply", SQUARE.replace("1 1 0\n", "1e36 1e36 0\n"))
    result = kerf("render", "a.ply", "-o", "out.png", *QUICK)
    assert result.returncode == 0, result.stderr


def test_output_is_judged_before_any_work():
    slow = ["--size", "10000x10000", "--structure", "brute_force"]  # hours, if it were begun
    for output in ["out.gif", "nowhere/out.png"]:
        assert kerf("render", "square.ply", "-o", output, *slow).returncode == 1
    assert kerf("render", "missing.ply", "--structure", "binned_shah").returncode == 2


def test_standard_output_that_is_full_ends_with_1():
    with open("/dev/full", "w") as full:
        for command in [["list"], ["list", "--json", "-"], ["render", "square.ply", *QUICK, "--quiet", "--json", "-"]]:
            assert subprocess.run([KERF, *command], stdout=full, stderr=subprocess.PIPE).returncode == 1, command


def test_a_failed_write_leaves_the_former_file(folder):
    (folder / "out.pfm").write_text("precious")
    assert kerf("render", "missing.ply", "-o", "out.pfm").returncode == 1
    assert (folder / "out.pfm").read_text() == "precious"


def test_an_interrupt_writes_what_is_there_and_ends_with_130(folder):
    # Enough triangles that brute force takes far longer than the wait, and the handler is surely there after it.
    count, rows = 20000, 1500
    vertices = "".join(f"{i % 100} {i // 100} {c}\n{i % 100 + 1} {i // 100} {c}\n{i % 100} {i // 100 + 1} {c}\n"
                       for i, c in ((i, i % 7) for i in range(count)))
    faces = "".join(f"3 {3 * i} {3 * i + 1} {3 * i + 2}\n" for i in range(count))
    header = SQUARE[:SQUARE.index("end_header")].replace("vertex 4", f"vertex {3 * count}")
    broken("many.ply", header.replace("face 1", f"face {count}") + "end_header\n" + vertices + faces)
    process = subprocess.Popen([KERF, "render", "many.ply", "-o", "out.pfm", "--view", "depth", "--size",
                                f"2000x{rows}", "--structure", "brute_force", "--threads", "1", "--eye", "50,100,40",
                                "--look-at", "50,100,0"], stderr=subprocess.PIPE)
    wait_for_handler(process)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    assert "interrupted" in process.stderr.read().decode()
    pixels = [value for row in read_pfm("out.pfm") for value in row]
    assert len(pixels) == 2000 * rows
    assert any(value != float("inf") for value in pixels), "what was reached is there"


def test_an_interrupt_ends_a_build_with_130(folder):
    assert kerf("make", "plant", "--triangles", "300000", "-o", "plant.ply").returncode == 0
    for command in [["render", "plant.ply", "-o", "out.png"], ["inspect", "plant.ply"],
                    ["study", "plant.ply", "--rows", "bsp_sah", "--size", "8x8"]]:
        structure = [] if command[0] == "study" else ["--structure", "bsp_sah"]  # takes minutes
        process = subprocess.Popen([KERF, *command, *structure], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        wait_for_handler(process)
        time.sleep(1)
        start = time.time()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130, command
        assert time.time() - start < 2, command
    assert not (folder / "out.png").exists()


def test_the_picture_is_the_same_for_any_threads_and_structure_and_another_for_another_seed(folder):
    def picture(*more):
        result = kerf("render", "square.ply", "-o", "out.pfm", *QUICK, *CAMERA, *more)
        assert result.returncode == 0, result.stderr
        return (folder / "out.pfm").read_bytes()
    first = picture("--threads", "1")
    assert picture("--threads", "3") == first
    assert picture("--structure", "early_split(sa_max=0.1)+sweep_sah") == first
    assert picture("--seed", "1") != first


def test_compare_says_what_rays_cost_in_both_structures():
    result = kerf("render", "square.ply", *QUICK, "--compare", "spatial_median", "--json", "-")
    assert result.returncode == 0, result.stderr
    plain, own = json.loads(result.stdout)["comparison"]
    assert plain["structure"] == "spatial_median"
    assert own["structure"].startswith("early_split(sa_max=auto)+binned_sah+reinsertion"), "balanced, by default"
    for cost in (plain, own):
        assert cost["rays"] > 30000 and cost["nodes_per_ray"] > 0.1 and cost["nanoseconds_per_ray"] > 1
    assert "times as fast" in result.stderr and "spatial_median: " in result.stderr


def test_an_interrupted_picture_is_whole(folder):
    process = subprocess.Popen([KERF, "render", "square.ply", "-o", "out.pfm", "--size", "64x48", "--spp", "1000000"],
                               stderr=subprocess.PIPE)
    wait_for_handler(process)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    assert "interrupted" in process.stderr.read().decode()
    assert all(value > 0 for row in read_pfm("out.pfm") for value in row)


def test_check_says_what_is_there_and_writes_nothing(folder):
    before = sorted(os.listdir(folder))
    result = kerf("check", "square.ply")
    assert result.returncode == 0 and "2 primitives" in result.stdout, result.stderr
    figures = json.loads(kerf("check", "square.ply", "--json", "-").stdout)
    assert figures["objects"] == 1 and figures["scene"]["primitives"] == 2 and figures["notes"] == []
    assert kerf("check", "missing.ply").returncode == 1
    assert sorted(os.listdir(folder)) == before


if __name__ == "__main__":
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
