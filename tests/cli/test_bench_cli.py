"""kerf bench as a user meets it. KERF names the program."""

import json
import math
import os
import random
import re
import signal
import subprocess
import sys
import time

import pytest

KERF = os.environ["KERF"]
KEYS = {"scene", "engine", "quality", "layout", "isa", "rays", "mode", "mrays_per_second", "build_seconds", "bytes", "hits"}
QUICK = ["--size", "31x23", "--repeat", "2"]


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
    write_slivers(tmp_path / "slivers.obj", 500)
    return tmp_path


def kerf(*arguments, **options):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def has_embree():
    return kerf("bench", "missing.obj", "--against", "embree").returncode != 2


def bench(*arguments):
    result = kerf("bench", *arguments, *QUICK, "--json", "-", "--quiet")
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""
    return json.loads(result.stdout)


def test_help_has_an_example_and_the_command_is_listed():
    result = kerf("bench", "--help")
    assert result.returncode == 0
    assert "kerf bench hall.ply" in result.stdout
    assert re.search(r"^\s+bench\s", kerf("--help").stdout, re.M)


def test_the_table_is_printed_and_the_file_is_one_array():
    result = kerf("bench", "slivers.obj", *QUICK, "--turn", "straight,xyz", "--json", "out.json")
    assert result.returncode == 0, result.stderr
    rows = json.load(open("out.json"))
    assert isinstance(rows, list) and all(KEYS <= row.keys() for row in rows)
    assert {row["turn"] for row in rows} == {"straight", "xyz"}
    assert {row["rays"] for row in rows} == {"primary", "diffuse", "shadow"}
    ours = [row for row in rows if row["engine"] == "kerf"]
    assert {"fast", "balanced", "best"} <= {row["quality"] for row in ours}
    assert {row["mode"] for row in ours} == {"single", "batch"}
    for row in rows:
        assert row["finished"] and row["mrays_per_second"] > 0 and row["build_seconds"] > 0 and row["bytes"] > 0
        assert row["mrays_spread"]["least"] <= row["mrays_per_second"] * 1.0001
        assert row["unlike_kerf"] == (0 if row["engine"] == "kerf" else None)
    for turn in ("straight", "xyz"):
        for rays in ("primary", "diffuse", "shadow"):
            assert len({row["hits"] for row in ours if (row["turn"], row["rays"]) == (turn, rays)}) == 1
    for words in ("slivers turned xyz: 500 triangles; 1 thread", "balanced", "Mray/s"):
        assert words in result.stdout


@pytest.mark.skipif(not has_embree(), reason="Embree was not found")
def test_embree_stands_beside_it():
    rows = bench("slivers.obj", "--rows", "balanced", "--rays", "diffuse")
    rivals = {(row["quality"], row["feed"]): row for row in rows if row["engine"] == "embree"}
    assert {"high", "medium", "robust"} <= {quality for quality, _ in rivals}
    high = rivals["high", "loop"]
    assert high["mode"] == "single" and high["ratio_to_embree_high"] == 1 and high["builder"] and high["isa"]
    assert rivals["high", "sorted"]["mode"] == "batch"
    assert high["references"] >= 499 and rivals["robust", "loop"]["unlike_robust"] == 0
    assert all(row["unlike_robust"] <= 5 for row in rows)
    result = kerf("bench", "slivers.obj", *QUICK, "--rows", "balanced", "--rays", "diffuse")
    assert re.search(r"Embree [34]\.\d+.*huge pages: .*FTZ and DAZ", result.stdout)
    for words in ("Embree HIGH", "Embree ROBUST", "0 unexplained", "goals:", "not measured", "Spatial"):
        assert words in result.stdout, words


def test_without_a_rival_there_is_nothing_to_judge():
    result = kerf("bench", "slivers.obj", *QUICK, "--against", "none", "--rows", "binned_sah+skip_pointer,brute_force")
    assert result.returncode == 0, result.stderr
    assert "Embree HIGH" not in result.stdout.split("\n\n", 2)[2] and "goals" not in result.stdout
    rows = bench("slivers.obj", "--against", "none", "--rows", "binned_sah+skip_pointer", "--rays", "primary")
    assert [(row["engine"], row["quality"], row["layout"], row["mode"]) for row in rows] == [
        ("kerf", "binned_sah", "skip_pointer", "single"), ("kerf", "binned_sah", "skip_pointer", "batch")]
    assert rows[0]["isa"] == "scalar" and rows[0]["ratio_to_embree_high"] is None


def test_growth_and_rows_that_reach_a_limit():
    rows = bench("--growth", "soup", "--up-to", "2e4", "--rows", "binned_sah", "--rays", "primary", "--against", "none")
    assert {row["scene"] for row in rows} == {"soup 10000"}
    rows = bench("slivers.obj", "--rows", "binned_sah,brute_force", "--limit-gigabytes", "0.00005", "--rays", "primary",
                 "--against", "none")
    assert not rows[0]["finished"] and "bytes" in rows[0]["why_not"] and rows[0]["mrays_per_second"] is None
    assert rows[0]["short_of_room"] is None


def test_a_row_without_room_for_its_cuts_says_so():
    quiet = ["--rows", "spatial_split(cap=8)+bvh2", "--rays", "primary", "--against", "none"]
    assert all(row["short_of_room"] == [] for row in bench("slivers.obj", *quiet))
    tight = [*quiet, "--limit-gigabytes", "0.0001"]
    assert all(row["short_of_room"] == ["spatial_split"] for row in bench("slivers.obj", *tight))
    result = kerf("bench", "slivers.obj", *QUICK, *tight)
    assert "the limit of bytes left spatial_split no room to cut" in result.stdout
    assert "raise --limit-gigabytes" in result.stdout


def test_a_row_of_cameras_and_words_of_the_camera_are_used(folder):
    far = bench("slivers.obj", "--rows", "binned_sah", "--rays", "primary", "--against", "none", "--eye", "0,0,2000",
                "--look-at", "0,0,0")
    near = bench("slivers.obj", "--rows", "binned_sah", "--rays", "primary", "--against", "none")
    assert far[0]["hits"] < near[0]["hits"]


@pytest.mark.parametrize("words, sentence", [
    ([], "give a scene"),
    (["slivers.obj", "--against", "embre"], "did you mean 'embree'"),
    (["slivers.obj", "--rows", "binned_shah"], "binned_sah"),
    (["slivers.obj", "--rays", "primry"], "did you mean 'primary'"),
    (["slivers.obj", "--turn", "x,yx"], "unknown turn 'yx'"),
    (["slivers.obj", "--threads", "two"], "'two' is not a number of threads"),
    (["slivers.obj", "--threads", "1,99999"], "--threads"),
    (["slivers.obj", "--size", "0x3"], "--size"),
    (["slivers.obj", "--up-to", "20000"], "--growth"),
    (["slivers.obj", "--growth", "soup"], "give no input"),
    (["--growth", "soop"], "soup"),
    (["--growth", "soup", "--fov", "30"], "cameras of their own"),
    (["slivers.obj", "--limit-seconds", "-1"], "limit-seconds"),
    (["slivers.obj", "--repeats", "3"], "did you mean '--repeat'"),
])
def test_mistakes_in_the_words_end_with_2_and_write_nothing(folder, words, sentence):
    before = sorted(os.listdir(folder))
    result = kerf("bench", *words)
    assert result.returncode == 2 and sentence in result.stderr, result.stderr
    assert result.stdout == "" and sorted(os.listdir(folder)) == before


def test_a_misspelt_command_is_named():
    result = kerf("bensh", "slivers.obj")
    assert result.returncode == 2 and "bench" in result.stderr


def test_bad_input_ends_with_1(folder):
    assert kerf("bench", "missing.obj").returncode == 1
    assert kerf("bench", "slivers.obj", "--json", "no/such/folder.json").returncode == 1
    (folder / "cut.obj").write_text("v 1 2\n")
    result = kerf("bench", "cut.obj")
    assert result.returncode == 1 and "cut.obj:1" in result.stderr


def test_an_interrupt_writes_what_is_measured_and_ends_with_130(folder):
    write_slivers(folder / "many.obj", 5000)
    process = subprocess.Popen([KERF, "bench", "many.obj", "--rows", "binned_sah", "--size", "60x40", "--json", "out.json",
                                "--repeat", "1000"], stdout=subprocess.PIPE, text=True)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    text, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    rows = json.load(open("out.json"))
    assert rows and "many: 5000 triangles" in text
    assert all(row["finished"] or row["why_not"] for row in rows)
    assert any(row["finished"] for row in rows)
    assert all(math.isfinite(row["mrays_per_second"]) for row in rows if row["finished"])


if __name__ == "__main__":
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
