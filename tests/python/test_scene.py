"""The Python module: shapes, types, strides, errors, lifetimes, and agreement with a brute force in numpy."""

import gc
import re
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import kerf

SQUARE = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
DOWN = [0, 0, -1]


def random_mesh(count, seed=1):
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.uniform(-0.3, 0.3, (count, 3, 3))
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)


def random_rays(count, seed=2):
    random = np.random.default_rng(seed)
    return random.uniform(-2, 2, (count, 3)).astype(np.float32), random.normal(size=(count, 3)).astype(np.float32)


def brute_force(vertices, faces, origins, directions):
    """t of all rays by all triangles in double, infinite for a miss (Moeller, Trumbore 1997)."""
    a, b, c = (vertices[faces[:, k]].astype(np.float64) for k in range(3))
    o, d = origins[:, None].astype(np.float64), directions[:, None].astype(np.float64)
    p = np.cross(d, c - a)
    inverse = 1 / np.sum((b - a) * p, -1)
    u = np.sum((o - a) * p, -1) * inverse
    q = np.cross(o - a, (b - a)[None])
    v = np.sum(d * q, -1) * inverse
    t = np.sum((c - a) * q, -1) * inverse
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0), t, np.inf)


@pytest.mark.parametrize("structure", ["binned_sah", "early_split(budget=1.5)+sweep_sah", "brute_force"])
def test_agrees_with_numpy(structure):
    vertices, faces = random_mesh(200)
    origins, directions = random_rays(3000)
    t = brute_force(vertices, faces, origins, directions)
    hits = kerf.Scene(vertices, faces, structure).closest_hit(origins, directions)
    np.testing.assert_array_equal(hits.hit, np.isfinite(t.min(1)))
    np.testing.assert_array_equal(hits.primitive, np.where(hits.hit, t.argmin(1), -1))
    np.testing.assert_allclose(hits.t, t.min(1), rtol=1e-5)
    assert 100 < hits.hit.sum() < 2900
    a, b, c = (vertices[faces[hits.primitive[hits.hit], k]] for k in range(3))
    u, v = hits.u[hits.hit, None], hits.v[hits.hit, None]
    points = origins[hits.hit] + hits.t[hits.hit, None] * directions[hits.hit]
    np.testing.assert_allclose(points, a + u * (b - a) + v * (c - a), atol=1e-4)


@pytest.mark.parametrize("structure", ["binned_sah", "early_split(budget=2)+lbvh"])
def test_refit_follows_moved_vertices(structure):
    vertices, faces = random_mesh(200)
    origins, directions = random_rays(3000)
    scene = kerf.Scene(vertices, faces, structure, refittable=True)
    for moved in (vertices @ np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], np.float32), (2 * vertices).tolist(), vertices):
        report = scene.refit(moved)
        gc.collect()
        hits = scene.closest_hit(origins, directions)
        t = brute_force(np.asarray(moved, np.float32), faces, origins, directions)
        np.testing.assert_array_equal(hits.primitive, np.where(np.isfinite(t.min(1)), t.argmin(1), -1))
        assert 0.9 < report["growth"] < 1.1 and not report["should_rebuild"]
    vertices[:] = np.random.default_rng(3).permutation(vertices)
    report = scene.refit(vertices)
    assert report["growth"] > 1.5 and report["should_rebuild"]
    assert report["sah_cost"] > report["built_sah_cost"] > 0


def test_refit_refuses():
    with pytest.raises(kerf.Error, match="refittable") as error:
        kerf.Scene(SQUARE, FACES).refit(SQUARE)
    assert error.value.code == "invalid_option"
    scene = kerf.Scene(SQUARE, FACES, refittable=True)
    bad = SQUARE.copy()
    bad[3, 1] = np.nan
    for vertices, code in ((bad, "invalid_geometry"), (SQUARE[:3], "invalid_geometry"), (SQUARE[:, :2], "invalid_argument")):
        with pytest.raises(kerf.Error) as error:
            scene.refit(vertices)
        assert error.value.code == code
        assert scene.closest_hit([1, 3, 5], DOWN).t == 5


def test_types_of_results():
    hits = kerf.Scene(SQUARE, FACES).closest_hit([[1, 3, 5], [9, 9, 5]], [DOWN, DOWN])
    assert [x.dtype for x in hits] == [np.float32, np.float32, np.float32, np.int64, np.bool_]
    assert hits.primitive.tolist() == [1, -1] and hits.hit.tolist() == [True, False]
    assert hits.t.tolist() == [5, np.inf] and hits.u.tolist() == [0.25, 0] and hits.v.tolist() == [0.5, 0]
    assert hits._fields == ("t", "u", "v", "primitive", "hit") and type(hits) is kerf.Hits


def test_one_ray_and_broadcasting():
    scene = kerf.Scene(SQUARE, FACES)
    hits = scene.closest_hit([1, 3, 5], DOWN)
    assert hits.t.shape == () and float(hits.t) == 5 and hits.hit and int(hits.primitive) == 1
    assert scene.any_hit([1, 3, 5], DOWN).shape == ()
    assert scene.closest_hit([1, 3, 5], [DOWN] * 4).t.tolist() == [5] * 4
    assert scene.closest_hit(np.ones((6, 7, 3)), DOWN).t.shape == (6, 7)
    assert scene.closest_hit([1, 3, 5], DOWN, t_max=[4, 5, 6]).hit.tolist() == [False, True, True]
    assert scene.closest_hit(np.zeros((0, 3)), np.zeros((0, 3))).t.shape == (0,)
    assert scene.any_hit(np.zeros((0, 3)), DOWN).shape == (0,)


def test_interval_is_closed():
    scene = kerf.Scene(SQUARE, FACES)
    origins = np.tile([1.0, 3.0, 5.0], (4, 1))
    t_min, t_max = np.array([0, 5, 5.1, 0]), np.array([5, 5, 9, 4.9])
    assert scene.any_hit(origins, DOWN, t_min, t_max).tolist() == [True, True, False, False]
    assert scene.closest_hit(origins, DOWN, t_min=t_min, t_max=t_max).hit.tolist() == [True, True, False, False]
    assert scene.closest_hit([1, 3, -5], DOWN, t_min=-np.inf).t == -5


@pytest.mark.parametrize("dtype", ["<f4", ">f4", "f8", "f2", "i4", "u1", "i8"])
def test_vertex_types(dtype):
    assert kerf.Scene(SQUARE.astype(dtype), FACES).closest_hit([1, 3, 5], DOWN).primitive == 1


@pytest.mark.parametrize("dtype", ["<u4", ">u4", "i4", "i8", "u8", "i2", "u1"])
def test_face_types(dtype):
    assert kerf.Scene(SQUARE, FACES.astype(dtype)).closest_hit([1, 3, 5], DOWN).primitive == 1


def test_lists():
    assert kerf.Scene(SQUARE.tolist(), FACES.tolist()).any_hit([1, 3, 5], DOWN)


def strided(array):
    """The same numbers in memory of all kinds."""
    wide = np.full((2 * len(array), 5), 77, array.dtype)
    wide[::2, 1:4] = array
    yield wide[::2, 1:4]
    yield np.asfortranarray(array)
    yield np.ascontiguousarray(array[::-1])[::-1]
    yield np.ascontiguousarray(array[:, ::-1])[:, ::-1]
    unaligned = np.zeros(array.nbytes + 1, np.uint8)[1:].view(array.dtype).reshape(array.shape)
    unaligned[:] = array
    yield unaligned
    frozen = array.copy()
    frozen.flags.writeable = False
    yield frozen


def test_strides():
    vertices, faces = random_mesh(50)
    origins, directions = random_rays(500)
    expected = kerf.Scene(vertices, faces).closest_hit(origins, directions)
    for v, f in zip(strided(vertices), strided(faces)):
        for o, d in zip(strided(origins), strided(directions)):
            for got, want in zip(kerf.Scene(v, f).closest_hit(o, d), expected):
                np.testing.assert_array_equal(got, want)
    flat = np.zeros_like(vertices)  # one vertex for all, with a stride of 0
    assert kerf.Scene(np.broadcast_to(flat[:1], flat.shape), faces).report["degenerate"] == 50


def test_empty():
    for vertices, faces in [([], []), (np.zeros((0, 3)), np.zeros((0, 3), int)), (SQUARE, [])]:
        scene = kerf.Scene(vertices, faces)
        assert not scene.any_hit([1, 3, 5], DOWN) and scene.report["primitives"] == 0
        assert (scene.bounds[0] > scene.bounds[1]).all()


@pytest.mark.parametrize("faces, number", [
    ([[0, 1, 2], [0, 1, 4]], "4"),
    ([[0, 1, 2], [0, -1, 2]], "-1"),
    (np.array([[0, 1, 2], [0, 1, 2**32]]), "4294967296"),
    (np.array([[0, 1, 2], [0, 1, 2**64 - 1]], np.uint64), "18446744073709551615"),
])
def test_bad_faces(faces, number):
    with pytest.raises(kerf.Error, match=rf"1: vertex number {number} (of 4|is out of range)") as caught:
        kerf.Scene(SQUARE, faces)
    assert caught.value.code == "invalid_geometry" and "1" in caught.value.place
    scene = kerf.Scene(SQUARE, faces, skip_invalid=True)
    assert scene.report["invalid"] == 1 and scene.report["references"] == 1


@pytest.mark.parametrize("arguments, code, place", [
    (dict(vertices=SQUARE[:, :2]), "invalid_argument", "vertices"),
    (dict(vertices=SQUARE[0]), "invalid_argument", "vertices"),
    (dict(vertices=SQUARE.astype(complex)), "invalid_argument", "vertices"),
    (dict(vertices=[["a", "b", "c"]]), "invalid_argument", "vertices"),
    (dict(vertices=SQUARE * np.float32(np.nan)), "invalid_geometry", "geometry 0, triangle 0"),
    (dict(vertices=SQUARE.astype(float) * 1e37), "invalid_geometry", "geometry 0, triangle 0"),
    (dict(faces=FACES.astype(float)), "invalid_argument", "faces"),
    (dict(faces=FACES.astype(bool)), "invalid_argument", "faces"),
    (dict(faces=FACES[0]), "invalid_argument", "faces"),
    (dict(faces=np.zeros((2, 4), int)), "invalid_argument", "faces"),
    (dict(threads=-1), "invalid_argument", "threads"),
    (dict(structure="bined_sah"), "invalid_option", "structure 'bined_sah', column 1"),
])
def test_bad_scenes(arguments, code, place):
    with pytest.raises(ValueError) as caught:
        kerf.Scene(**(dict(vertices=SQUARE, faces=FACES) | arguments))
    assert type(caught.value) is kerf.Error
    assert (caught.value.code, caught.value.place) == (code, place)
    assert str(caught.value).startswith(place + ": ")


@pytest.mark.parametrize("rays", [
    (np.zeros((2, 2)), DOWN),
    (np.zeros(()), DOWN),
    (np.zeros((2, 3)), np.ones((3, 3))),
    (np.zeros((2, 3)), DOWN, np.zeros(3)),
    (np.zeros((2, 3)), DOWN, "0"),
    (np.zeros((2, 3), complex), DOWN),
])
def test_bad_rays(rays):
    scene = kerf.Scene(SQUARE, FACES)
    for query in scene.closest_hit, scene.any_hit:
        with pytest.raises(kerf.Error) as caught:
            query(*rays)
        assert caught.value.code == "invalid_argument"


def test_wrong_python_types():
    for call in (lambda: kerf.Scene(SQUARE, FACES, structure=3), lambda: kerf.Scene(SQUARE), lambda: kerf.Scene()):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(kerf.Error):
        kerf.Scene(None, FACES)


def test_arrays_live_as_long_as_the_scene():
    origins, directions = random_rays(2000)
    expected = kerf.Scene(*random_mesh(5000)).closest_hit(origins, directions)
    vertices, faces = random_mesh(5000)
    scene = kerf.Scene(vertices, faces)
    del vertices, faces
    gc.collect()
    garbage = [np.full((15000, 3), np.nan, np.float32) for _ in range(20)]  # over the memory, had it been freed
    np.testing.assert_array_equal(scene.closest_hit(origins, directions).primitive, expected.primitive)
    del garbage


def test_converted_arrays_are_copies():
    vertices = SQUARE.astype(np.float64)
    scene = kerf.Scene(vertices, FACES)
    vertices[:] = 0
    assert scene.any_hit([1, 3, 5], DOWN)


def test_thread_counts_change_nothing():
    mesh, rays = random_mesh(3000), random_rays(5000)
    scenes = [kerf.Scene(*mesh, "early_split(budget=2)+binned_sah", threads=k) for k in (0, 1, 3)]
    assert len({scene.report["tree_hash"] for scene in scenes}) == 1
    first, *others = [scene.closest_hit(*rays) for scene in scenes]
    for other in others:
        for a, b in zip(first, other):
            np.testing.assert_array_equal(a, b)


def test_queries_from_many_threads():
    scene, rays = kerf.Scene(*random_mesh(1000)), random_rays(20000)
    expected, results = scene.closest_hit(*rays).t, [None] * 4

    def work(k):
        results[k] = scene.closest_hit(*rays).t

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        np.testing.assert_array_equal(result, expected)


def test_other_threads_run_while_one_builds_and_traces():
    """If the lock were held, another thread would stand still for as long."""
    longest, done = [0.0], threading.Event()

    def tick():
        last = time.perf_counter()
        while not done.is_set():
            now = time.perf_counter()
            longest[0] = max(longest[0], now - last)
            last = now

    mesh, rays = random_mesh(50000), random_rays(30000)
    other = threading.Thread(target=tick)
    other.start()
    try:
        start = time.perf_counter()
        scene = kerf.Scene(*mesh, "sweep_sah", threads=1)
        built = time.perf_counter()
        while_building, longest[0] = longest[0], 0.0
        start_tracing = time.perf_counter()
        scene.closest_hit(*rays)
        traced = time.perf_counter()
        while_tracing = longest[0]
    finally:
        done.set()
        other.join()
    assert while_building < 0.6 * (built - start) and while_tracing < 0.6 * (traced - start_tracing)


@pytest.mark.parametrize("triangles", [1, 50000])  # one that is over before anybody asks, and one that takes long
def test_a_build_tells_how_far_it_is(triangles):
    told = []
    kerf.Scene(*random_mesh(triangles), "sweep_sah", progress=lambda share, what: told.append((share, what)))
    shares = [share for share, _ in told]
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == 1
    assert all(isinstance(what, str) and what for _, what in told)


def test_a_build_that_is_not_wanted_ends():
    with pytest.raises(kerf.Error) as error:
        kerf.Scene(*random_mesh(200000), "sweep_sah", threads=1, progress=lambda share, what: False)
    assert error.value.code == "stopped"
    calls = []

    def fail(share, what):
        calls.append(share)
        raise LookupError("no more")

    with pytest.raises(LookupError, match="no more"):
        kerf.Scene(*random_mesh(200000), "sweep_sah", threads=1, progress=fail)
    assert len(calls) == 1


def test_an_interrupt_ends_a_build():
    mesh = random_mesh(300000)
    start = time.perf_counter()
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        kerf.Scene(*mesh, "spatial_split(cap=8)", threads=1)  # half a minute
    assert time.perf_counter() - start < 5


def test_memory_is_bounded():
    mesh = random_mesh(10000)
    report = kerf.Scene(*mesh).report
    assert report["bytes"] < report["peak_bytes"] < 3 * report["bytes"]
    with pytest.raises(kerf.Error, match="it needs [0-9]+ bytes, and 1000 are allowed") as error:
        kerf.Scene(*mesh, max_bytes=1000)
    assert error.value.code == "stopped"
    assert kerf.Scene(*mesh, max_bytes=100_000_000).report["peak_bytes"] == report["peak_bytes"]
    assert report["short_of_room"] == []
    tight = kerf.Scene(*mesh, "spatial_split(cap=8)", max_bytes=2_000_000).report
    assert tight["short_of_room"] == ["spatial_split"] and tight["peak_bytes"] <= 2_000_000


def test_report_bounds_menu_version():
    scene = kerf.Scene(SQUARE, FACES, structure="early_split( budget=2 )+binned_sah")
    report = scene.report
    assert report["structure"] == "early_split(budget=2)+binned_sah"
    assert report["instruction_set"] == "scalar"
    assert report["primitives"] == 2 and report["references"] >= 2 and report["bytes"] > 0 and not report["capped"]
    assert set(report["seconds"]) == {"references", "split", "build", "optimise", "layout", "total"}
    assert scene.bounds.dtype == np.float32 and scene.bounds.tolist() == [[0, 0, 0], [4, 4, 0]]
    by_name = {entry["name"]: entry for entry in kerf.menu()}
    assert {"early_split", "binned_sah", "brute_force"} <= set(by_name)
    assert by_name["early_split"]["kind"] == "splitter"
    assert any(option["name"] == "budget" for option in by_name["early_split"]["options"])
    for name, entry in by_name.items():
        if entry["kind"] != "splitter":
            structure = f"binned_sah+{name}" if entry["kind"] in ("optimiser", "layout") else name
            assert kerf.Scene(SQUARE, FACES, structure).any_hit([1, 3, 5], DOWN)
    assert re.fullmatch(r"\d+\.\d+\.\d+", kerf.__version__)


def test_documentation(capsys):
    """The examples in docs/python.md run, and print what stands in the comments behind print()."""
    text = (Path(__file__).parents[2] / "docs" / "python.md").read_text()
    code = "\n".join(re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE))
    exec(compile(code, "docs/python.md", "exec"), {})
    expected = re.findall(r"print\(.*\)  # (.*)", code)
    assert expected and capsys.readouterr().out.splitlines() == expected
