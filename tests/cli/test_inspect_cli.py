"""kerf inspect as a user meets it. KERF names the program."""

import json
import os
import subprocess

import pytest

KERF = os.environ["KERF"]
SIDE = 20
# A floor of small triangles, and number 800: a long thin one aslant through it.
VERTICES = [(x, y, 0) for y in range(SIDE + 1) for x in range(SIDE + 1)] + [(0, 0, -1), (SIDE, SIDE, 5), (SIDE, SIDE - 0.01, 5)]
CELLS = [y * (SIDE + 1) + x for y in range(SIDE) for x in range(SIDE)]
FACES = [f for c in CELLS for f in ((c, c + 1, c + SIDE + 1), (c + 1, c + SIDE + 2, c + SIDE + 1))]
FACES.append((len(VERTICES) - 3, len(VERTICES) - 2, len(VERTICES) - 1))
QUICK = ["--size", "40x40", "--eye", "10,10,30", "--look-at", "10,10,0", "--structure", "binned_sah"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = ["ply", "format ascii 1.0", f"element vertex {len(VERTICES)}", "property float x", "property float y",
             "property float z", f"element face {len(FACES)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, v)) for v in VERTICES] + ["3 " + " ".join(map(str, f)) for f in FACES]
    (tmp_path / "floor.ply").write_text("\n".join(lines) + "\n")


def kerf(*arguments):
    return subprocess.run([KERF, "inspect", *arguments], capture_output=True, text=True, timeout=120)


def test_names_the_sliver_in_text():
    result = kerf("floor.ply", *QUICK)
    assert result.returncode == 0 and result.stderr == ""
    assert "half of all tests are of" in result.stdout.splitlines()[0]
    table = result.stdout.split("that rays test most")[1].splitlines()
    assert table[2].split()[:2] == ["1", "800"]
    assert table[3].strip() == "(0, 0, -1) (20, 20, 5) (20, 19.99, 5)"
    for part in ("Tried: early_split(sa_max=auto)+binned_sah", "Depth of leaves", "Slots in leaves", "bytes of the geometry"):
        assert part in result.stdout


def test_json_holds_everything():
    result = kerf("floor.ply", *QUICK, "--json", "-", "--top", "1000")
    assert result.returncode == 0
    figures = json.loads(result.stdout)
    assert figures["is_attributed"] and len(figures["findings"]) == 5
    assert figures["rays"]["primary"] == 1600
    assert sum(p["tests"] for p in figures["most_tested"]) == figures["rays"]["tests"]
    assert sum(p["hits"] for p in figures["most_tested"]) == figures["rays"]["hits"]
    assert figures["most_tested"][0]["primitive"] == figures["most_wasted"][0]["primitive"] == 800
    assert len(figures["most_wasted"]) == 801
    assert sum(figures["leaves_by_depth"]) == sum(figures["leaves_by_size"]) == figures["scene"]["leaves"]
    assert figures["trial"]["end_point_overlap"] < figures["end_point_overlap"]
    assert figures["trial"]["split"] > 0


def test_json_file_stands_beside_the_text_and_quiet_leaves_only_it():
    assert "Depth of leaves" in kerf("floor.ply", *QUICK, "--json", "out.json").stdout
    with open("out.json") as file:
        assert json.load(file)["input"] == "floor.ply"
    result = kerf("floor.ply", *QUICK, "--quiet", "--json", "quiet.json")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert os.path.exists("quiet.json")


def test_counts_repeat_for_any_number_of_threads():
    def counts(threads):
        figures = json.loads(kerf("floor.ply", *QUICK, "--json", "-", "--threads", threads).stdout)
        return [figures[k] for k in ("rays", "shares", "most_tested", "typical", "end_point_overlap", "bytes")]
    assert counts("1") == counts("3")


@pytest.mark.parametrize("words, code, sentence", [
    (["--trial", "binned_sa"], 2, "binned_sah"),
    (["--structure", "sah"], 2, "structure"),
    (["--size", "40"], 2, "--size"),
    (["--size", "9999x9999"], 2, "pixels"),
    (["--tops", "3"], 2, "--top"),
    (["--json", "no/such/out.json"], 1, "no/such"),
])
def test_mistakes_are_named(words, code, sentence):
    result = kerf("floor.ply", *words)
    assert result.returncode == code and sentence in result.stderr and result.stdout == ""


def test_no_trial_and_no_names():
    result = kerf("floor.ply", *QUICK, "--trial", "none", "--top", "0")
    assert result.returncode == 0 and "Tried" not in result.stdout and "test most" not in result.stdout


def test_an_instruction_set_can_be_asked_for(monkeypatch):
    wide = [*QUICK[:-1], "binned_sah+bvh8"]
    found = {}
    for name in ("scalar", "", "avx3"):
        monkeypatch.setenv("KERF_ISA", name)
        found[name] = kerf("floor.ply", *wide, "--json", "-", "--quiet")
    assert json.loads(found["scalar"].stdout)["scene"]["instruction_set"] == "scalar"
    assert found[""].returncode == 0, "empty: none is asked for"
    assert found["avx3"].returncode != 0
    assert "no instruction set 'avx3'" in found["avx3"].stderr and not found["avx3"].stdout
