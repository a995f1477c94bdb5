"""kerf study as a user meets it. KERF names the program."""

import csv
import json
import math
import os
import random
import signal
import subprocess
import sys
import time

import pytest

KERF = os.environ["KERF"]
KEYS = {"scene", "triangles", "row", "rays", "references_per_triangle", "build_seconds", "nodes_per_ray",
        "triangles_per_ray", "boxes_per_ray", "trace_seconds", "speedup", "bytes", "depth", "sah_cost",
        "end_point_overlap", "hits"}
QUICK = ["--size", "32x24", "--repeat", "2"]


def write_slivers(path, count, seed=1):
    """Long thin triangles between random points, as an OBJ."""
    rng = random.Random(seed)
    lines = []
    for i in range(count):
        a = [rng.uniform(-10, 10) for _ in range(3)]
        b = [x + rng.uniform(-6, 6) for x in a]
        c = [(x + y) / 2 + rng.uniform(-0.1, 0.1) for x, y in zip(a, b)]
        lines += ["v " + " ".join(f"{x:.5f}" for x in p) for p in (a, b, c)]
        lines.append(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}")
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("KERF_SCENES", raising=False)
    write_slivers(tmp_path / "slivers.obj", 500)
    return tmp_path


def kerf(*arguments, **options):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def study(*arguments):
    result = kerf("study", *arguments, *QUICK, "--json", "-", "--quiet")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def test_help_has_an_example():
    result = kerf("study", "--help")
    assert result.returncode == 0
    assert "kerf study --paper" in result.stdout


def test_the_table_is_printed_and_files_are_written():
    result = kerf("study", "slivers.obj", *QUICK, "--rows", "binned_sah,early_split(budget=2)+binned_sah", "--csv",
                  "out.csv", "--json", "out.json", "--html", "out.html")
    assert result.returncode == 0, result.stderr
    assert "T_build" in result.stdout and "early_split(budget=2)+binned_sah" in result.stdout
    figures = json.load(open("out.json"))
    assert len(figures) == 2 and all(KEYS <= row.keys() for row in figures)
    rows = list(csv.DictReader(open("out.csv")))
    assert [row["row"] for row in rows] == [row["row"] for row in figures]
    for text, figure in zip(rows, figures):
        assert float(text["nodes_per_ray"]) == figure["nodes_per_ray"]
        assert int(text["hits"]) == figure["hits"] > 0
    page = open("out.html").read()
    assert "early_split(budget=2)" in page and page.startswith("<!")
    assert figures[0]["speedup"] == 1
    assert figures[1]["references_per_triangle"] == pytest.approx(2, rel=0.01)


def test_counts_repeat_exactly_for_any_number_of_threads():
    def counts(*more):
        kinds = "primary,shadow,ambient_occlusion,diffuse"
        rows = study("slivers.obj", "--rows", "binned_sah,early_split(budget=2)+sweep_sah", "--rays", kinds, *more)
        assert len(rows) == 8
        timed = {"build_seconds", "trace_seconds", "speedup", "build_seconds_spread", "trace_seconds_spread"}
        return [{key: value for key, value in row.items() if key not in timed} for row in rows]
    assert counts() == counts("--threads", "1") == counts("--threads", "3")


def test_rows_that_do_not_finish_say_so_and_the_others_go_on():
    rows = study("slivers.obj", "--rows", "binned_sah(leaf=1,depth=2),binned_sah")
    assert [row["finished"] for row in rows] == [False, True]
    assert "depth" in rows[0]["why_not"]
    result = kerf("study", "slivers.obj", *QUICK, "--rows", "binned_sah,sweep_sah", "--limit-gigabytes", "1e-6")
    assert result.returncode == 0
    assert result.stdout.count("not finished") == 2
    assert rows[0]["nodes_per_ray"] is None
    unlimited = kerf("study", "slivers.obj", *QUICK, "--rows", "binned_sah", "--limit-gigabytes", "inf")
    assert unlimited.returncode == 0 and "not finished" not in unlimited.stdout


def test_rows_without_room_for_their_cuts_say_so():
    rows = ["--rows", "binned_sah,early_split(budget=4)+spatial_split(cap=8)"]
    assert [row["short_of_room"] for row in study("slivers.obj", *rows)] == [[], []]
    tight = [*rows, "--limit-gigabytes", "0.0001"]
    assert [row["short_of_room"] for row in study("slivers.obj", *tight)] == [[], ["early_split", "spatial_split"]]
    result = kerf("study", "slivers.obj", *QUICK, *tight, "--csv", "out.csv")
    assert result.stdout.count("raise --limit-gigabytes") == 1
    assert [row["short_of_room"] for row in csv.DictReader(open("out.csv"))] == ["", "early_split+spatial_split"]


def test_rows_of_a_turned_sweep_are_those_of_the_turned_scene():
    for turn in ([], ["--turn", "xyz"]):
        rows = study("slivers.obj", "--sweep", "sa_max", *turn)
        assert [row["references_per_triangle"] for row in rows[3:6]] == pytest.approx([1.2, 1.35, 1.5], rel=0.02)


def test_every_row_of_all_that_splits_splits():
    for row in study("slivers.obj", "--rows", "all"):
        if "budget" in row["row"]:
            assert row["references_per_triangle"] > 1.2, row["row"]


def test_a_bad_input_among_good_ones_is_found_first_and_loses_nothing(folder):
    result = kerf("study", "slivers.obj", "missing.obj", "--json", "out.json")
    assert result.returncode == 1 and "missing.obj" in result.stderr and not os.path.exists("out.json")
    (folder / "broken.obj").write_text("f 1 2 3\n")
    result = kerf("study", "slivers.obj", "broken.obj", *QUICK, "--rows", "binned_sah", "--json", "out.json")
    assert result.returncode == 1 and "broken.obj" in result.stderr
    assert [row["scene"] for row in json.load(open("out.json"))] == ["slivers"]


def test_rays_are_saved_and_loaded():
    first = study("slivers.obj", "--rays", "primary,diffuse", "--rows", "binned_sah", "--save-rays", "rays.npy")
    second = study("slivers.obj", "--rows", "binned_sah", "--load-rays", "rays.npy")
    assert [(r["rays"], r["hits"], r["nodes_per_ray"]) for r in first] == \
           [(r["rays"], r["hits"], r["nodes_per_ray"]) for r in second]
    numpy = pytest.importorskip("numpy")
    rays = numpy.load("rays.npy")
    assert set(rays["kind"]) == {0, 3} and rays["origin"].shape[1] == 3
    plain = numpy.concatenate([rays["origin"], rays["direction"]], axis=1)[rays["kind"] == 0]
    for dtype in ("<f4", "<f8"):
        numpy.save("plain.npy", plain.astype(dtype))
        loaded = study("slivers.obj", "--rows", "binned_sah", "--load-rays", "plain.npy")
        assert loaded[0]["rays"] == "loaded" and loaded[0]["hits"] == first[0]["hits"]
    numpy.save("wrong.npy", plain[:, :5])
    result = kerf("study", "slivers.obj", "--load-rays", "wrong.npy")
    assert result.returncode == 1 and "(n, 6)" in result.stderr


def test_a_sweep_is_a_curve_over_the_area_limit():
    rows = study("slivers.obj", "--sweep", "sa_max")
    ratios = [row["references_per_triangle"] for row in rows]
    assert len(rows) >= 10 and ratios == sorted(ratios) and ratios[0] == 1 and ratios[-1] > 9
    assert rows[0]["sa_max"] == "inf" and all(row["sa_max"] > 0 for row in rows[1:])


def test_a_camera_list_beside_a_model_is_used_and_words_go_before_it(folder):
    plain = study("slivers.obj", "--rows", "binned_sah")
    (folder / "cameras.tsv").write_text("scene\tcamera\tex\tey\tez\tlx\tly\tlz\tux\tuy\tuz\tfov\n"
                                        "slivers\t1\t0\t0\t2000\t0\t0\t0\t0\t1\t0\t45\n")
    far = study("slivers.obj", "--rows", "binned_sah")
    assert far[0]["hits"] < plain[0]["hits"]
    near = study("slivers.obj", "--rows", "binned_sah", "--eye", "0,0,30", "--look-at", "0,0,0")
    assert near[0]["hits"] > far[0]["hits"]
    closer = study("slivers.obj", "--rows", "binned_sah", "--fov", "1")
    assert closer[0]["hits"] > far[0]["hits"], "a word changes its part of the listed camera"
    (folder / "cameras.tsv").write_text("names\nslivers 1 2\n")
    result = kerf("study", "slivers.obj", *QUICK)
    assert result.returncode == 1 and "cameras.tsv:2" in result.stderr


def test_a_turned_scene_has_a_name_of_its_own():
    rows = study("slivers.obj", "--rows", "binned_sah", "--turn", "xyz")
    assert rows[0]["scene"] == "slivers turned xyz"


def test_growth_goes_by_tens_and_all_rows_are_everything_in_the_menu():
    rows = study("--growth", "soup", "--up-to", "1e4", "--rows", "binned_sah,sweep_sah")
    assert [row["scene"] for row in rows] == ["soup 1000"] * 2 + ["soup 10000"] * 2
    assert rows[2]["triangles"] == pytest.approx(10000, rel=0.05)
    names = {row["row"] for row in study("slivers.obj", "--rows", "all")}
    menu = json.loads(kerf("list", "--json", "-").stdout)
    for entry in menu:
        if entry["kind"] in ("splitter", "builder", "optimiser", "layout", "structure") and entry["name"] not in ("bvh2", "brute_force"):
            assert any(entry["name"] in name for name in names), entry["name"]


def test_splitting_measures_each_turn_and_judges_the_goals(folder):
    assert kerf("make", "needles", "--triangles", "2000", "-o", "needles.ply", "--quiet").returncode == 0
    result = kerf("study", "needles.ply", "--splitting", "--turn", "straight,x", "--size", "40x30", "--repeat", "6",
                  "--rays", "primary,diffuse", "--json", "out.json", "--csv", "out.csv", "--html", "out.html")
    assert result.returncode == 0, result.stderr
    figures = json.load(open("out.json"))
    assert [(scene["scene"], scene["turn"]) for scene in figures["scenes"]] == [("needles", "straight"), ("needles", "x")]
    for scene in figures["scenes"]:
        rows = {row["row"]: row for row in scene["rows"]}
        assert sum(name.startswith("budget") for name in rows) >= 12
        for name in ("plain", "auto", "SBVH", "budget 1.5"):
            assert rows[name]["finished"], rows[name]
        assert rows["plain"]["references_per_primitive"] == 1
        assert rows["auto"]["split_choice"]["reason"] in result.stdout
        visits = [ray["nodes_per_ray"] + ray["triangles_per_ray"] for ray in rows["auto"]["rays"]]
        plain = [ray["nodes_per_ray"] + ray["triangles_per_ray"] for ray in rows["plain"]["rays"]]
        assert [ray["visits_of_plain"] for ray in rows["auto"]["rays"]] == pytest.approx([v / p for v, p in zip(visits, plain)])
        assert all(len(ray["trace_seconds"]) == 6 and len(ray["speed_interval"]) == 2 for ray in rows["auto"]["rays"])
        assert all(not row["finished"] and row["why_not"] for row in rows.values() if "rays" not in row)
        goals = {goal["goal"]: goal for goal in scene["goals"]}
        assert goals["hits"]["state"] == goals["cap"]["state"] == "reached"
        assert all(goal["state"] in ("reached", "missed", "not measured", "not asked") for goal in goals.values())
        assert all(goal["text"] in result.stdout for goal in goals.values())
    assert len(figures["goals"]) == len(figures["scenes"][0]["goals"])
    lines = list(csv.DictReader(open("out.csv")))
    assert len(lines) == sum(len(scene["rows"]) * 2 for scene in figures["scenes"])
    page = open("out.html").read()
    assert "Visits of all kinds of rays" in page and "needles turned x" in page


def test_splitting_counts_repeat_exactly():
    def counts(*more):
        result = kerf("study", "slivers.obj", "--splitting", "--turn", "xyz", "--size", "32x24", "--repeat", "1", "--quiet",
                      "--no-determinism", "--json", "-", *more)
        assert result.returncode == 0, result.stderr
        scene, = json.loads(result.stdout)["scenes"]
        assert any("left out as asked" in sentence for sentence in scene["skipped"])
        return [[(ray["nodes_per_ray"], ray["triangles_per_ray"], ray["hits"]) for ray in row.get("rays", [])]
                for row in scene["rows"]]
    assert counts() == counts("--threads", "1")


def test_an_interrupted_study_of_splitting_writes_what_is_finished(folder):
    write_slivers(folder / "many.obj", 20000)
    process = subprocess.Popen([KERF, "study", "many.obj", "--splitting", "--size", "60x40", "--json", "out.json",
                                "--repeat", "1000"], stdout=subprocess.PIPE)
    time.sleep(5)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    scene, = json.load(open("out.json"))["scenes"]
    assert all(row["finished"] or row["why_not"] for row in scene["rows"])
    assert scene["goals"][0]["state"] in ("reached", "missed", "not measured")


@pytest.mark.parametrize("words, sentence", [
    (["--splitting"], "give a scene"),
    (["slivers.obj", "--splitting", "--rows", "binned_sah"], "rows of its own"),
    (["slivers.obj", "--splitting", "--sweep", "sa_max"], "sweep of its own"),
    (["slivers.obj", "--splitting", "--turn", "x,yx"], "unknown turn 'yx'"),
    (["slivers.obj", "--splitting", "--save-rays", "x.npy"], "--splitting"),
    (["slivers.obj", "--splitting", "--no-overlap"], "no overlap"),
    (["--splitting", "--paper"], "--paper"),
    (["slivers.obj", "--turn", "x,y"], "unknown turn"),
    (["slivers.obj", "--no-determinism"], "--splitting"),
    (["--growth", "soop"], "soup"),
    (["--growth", "soup", "--paper"], "--paper"),
    ([], "give a scene"),
    (["slivers.obj", "--paper"], "give no input"),
    (["slivers.obj", "--rows", "binned_shah"], "binned_sah"),
    (["slivers.obj", "--rays", "primry"], "did you mean 'primary'"),
    (["slivers.obj", "--turn", "yx"], "turn"),
    (["slivers.obj", "--sweep", "samax"], "did you mean 'sa_max'"),
    (["slivers.obj", "--sweep", "sa_max", "--rows", "binned_sah"], "give no others"),
    (["slivers.obj", "slivers.obj", "--save-rays", "x.npy"], "one input"),
    (["slivers.obj", "--size", "0x3"], "--size"),
    (["slivers.obj", "--seeds", "2"], "--paper"),
    (["slivers.obj", "--up-to", "2000"], "--growth"),
    (["--growth", "soup", "--fov", "30"], "cameras of their own"),
    (["--paper", "--turn", "x"], "by itself"),
    (["slivers.obj", "--load-rays", "x.npy", "--rays", "diffuse"], "--load-rays"),
    (["slivers.obj", "--json", "-", "--csv", "-"], "one file only"),
    (["slivers.obj", "--limit-seconds", "-1"], "limit-seconds"),
    (["slivers.obj", "--repeats", "3"], "--repeat"),
])
def test_mistakes_in_the_words_end_with_2_and_write_nothing(folder, words, sentence):
    before = sorted(os.listdir(folder))
    result = kerf("study", *words)
    assert result.returncode == 2 and sentence in result.stderr, result.stderr
    assert result.stdout == "" and sorted(os.listdir(folder)) == before


def test_bad_input_ends_with_1(folder):
    assert kerf("study", "missing.obj").returncode == 1
    assert kerf("study", "slivers.obj", "--json", "no/such/folder.json").returncode == 1
    assert kerf("study", "slivers.obj", "--load-rays", "slivers.obj").returncode == 1


def test_an_interrupt_writes_what_is_finished_and_ends_with_130(folder):
    write_slivers(folder / "many.obj", 20000)
    process = subprocess.Popen([KERF, "study", "many.obj", "--rows", "brute_force,binned_sah", "--size", "400x400",
                                "--json", "out.json", "--repeat", "1000"], stdout=subprocess.PIPE)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    rows = json.load(open("out.json"))
    assert len(rows) == 2
    assert all(row["finished"] or row["why_not"] for row in rows)
    assert all(math.isfinite(row["trace_seconds"]) for row in rows if row["finished"])


if __name__ == "__main__":
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
