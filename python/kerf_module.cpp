// The Python module `kerf`: numpy arrays in, numpy arrays out. docs/python.md describes it.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/base/version.h"
#include "kerf/scene/menu.h"
#include "kerf/scene/scene.h"
#include "python/arrays.h"

namespace py = pybind11;

namespace kerf::python {
namespace {

constexpr py::ssize_t kBlock = 1024;  // rays that one thread works on at a time

const char* code_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_geometry:
      return "invalid_geometry";
    case ErrorCode::invalid_option:
      return "invalid_option";
    case ErrorCode::invalid_argument:
      return "invalid_argument";
    case ErrorCode::not_built:
      return "not_built";
    case ErrorCode::file:
      return "file";
    case ErrorCode::too_large:
      return "too_large";
    case ErrorCode::stopped:
      return "stopped";
  }
  return "";
}

/// A build on a thread of its own. Python's functions and its interrupts are seen to by the thread that waits for it,
/// with Python's lock; all else goes on without.
class WatchedBuild {
 public:
  WatchedBuild(Scene& scene, BuildOptions options, const py::object& progress) : progress_(progress) {
    options.limit.cancelled = &cancelled_;
    options.progress = [this](double share, std::string_view what) {
      const std::lock_guard lock(mutex_);
      share_ = share;
      what_ = what;
      return true;
    };
    thread_ = std::thread([this, &scene, options = std::move(options)] {
      try {
        scene.build(options);
      } catch (...) {
        failure_ = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      is_done_ = true;
      news_.notify_one();
    });
  }
  ~WatchedBuild() {
    if (!thread_.joinable()) return;
    cancelled_ = true;
    const py::gil_scoped_release release;
    thread_.join();
  }

  /// Returns when it is done. Throws what it throws, or a function of Python. Tells the beginning and the end however
  /// short the build is.
  void wait() {
    constexpr std::chrono::milliseconds kTellEvery(50);
    tell(0, "begin");
    for (bool is_done = false; !is_done;) {
      double share = 0;
      std::string what;
      {
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex_);
        is_done = news_.wait_for(lock, kTellEvery, [&] { return is_done_; });
        share = share_;
        what = what_;
      }
      if (is_done) {
        thread_.join();
        if (failure_) std::rethrow_exception(failure_);
      }
      tell(share, what);
    }
    if (cancelled_) throw Error(ErrorCode::stopped, "build", "it was cancelled");
  }

 private:
  void tell(double share, const std::string& what) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress_.is_none() && progress_(share, what).is(py::bool_(false))) cancelled_ = true;
  }

  const py::object& progress_;
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;  // of what follows
  std::condition_variable news_;
  double share_ = 0;
  std::string what_ = "begin";
  bool is_done_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

/// A scene of one mesh that keeps the arrays it looks at.
class MeshScene {
 public:
  MeshScene(const py::object& vertices, const py::object& faces, const std::string& structure, int threads,
            bool skip_invalid, bool refittable, const py::object& progress, std::optional<size_t> max_bytes)
      : vertices_(to_floats(vertices, "vertices")), faces_(to_faces(faces, skip_invalid)), threads_(threads) {
    if (threads < 0) refuse("threads", "0 or more are expected, not " + std::to_string(threads));
    check_rows(vertices_, "vertices");
    const auto corners = to_strided<Vec3f>(vertices_);
    scene_.add(TriangleMesh{corners, to_strided<TriangleCorners>(faces_)});
    BuildOptions options{
        .structure = structure, .threads = threads, .skip_invalid = skip_invalid, .refittable = refittable};
    if (max_bytes) options.limit.bytes = *max_bytes;
    WatchedBuild(scene_, std::move(options), progress).wait();
  }

  /// The array is looked at from now on, and kept; after an error the one before stays.
  py::dict refit(const py::object& vertices) {
    using namespace py::literals;
    py::array_t<float> moved = to_floats(vertices, "vertices");
    check_rows(moved, "vertices");
    const auto corners = to_strided<Vec3f>(moved);
    const Geometry geometry{TriangleMesh{corners, to_strided<TriangleCorners>(faces_)}};
    const RefitReport& r = [&]() -> const RefitReport& {
      const py::gil_scoped_release release;
      return scene_.refit({&geometry, 1}, threads_);
    }();
    vertices_ = std::move(moved);
    return py::dict("growth"_a = r.growth, "should_rebuild"_a = r.should_rebuild, "sah_cost"_a = r.sah_cost,
                    "built_sah_cost"_a = r.built_sah_cost, "left_out"_a = r.left_out, "bytes"_a = r.bytes,
                    "seconds"_a = r.seconds);
  }

  /// Calls query(rays, first, hits) for blocks of rays on all threads, without Python's lock.
  template <class Result, class F>
  void trace(const Rays& rays, F&& store) const {
    const py::gil_scoped_release release;
    with_threads(threads_, [&] {
      parallel_for(static_cast<size_t>(rays.count), kBlock, [&](size_t begin, size_t end) {
        std::array<Ray, kBlock> block;
        std::array<Result, kBlock> results;
        const size_t count = end - begin;
        for (size_t i = 0; i < count; ++i) block[i] = rays[static_cast<py::ssize_t>(begin + i)];
        const std::span<const Ray> given(block.data(), count);
        if constexpr (std::is_same_v<Result, Hit>) {
          scene_.closest_hit(given, std::span(results.data(), count), 1);
        } else {
          scene_.any_hit(given, std::span(results.data(), count), 1);
        }
        for (size_t i = 0; i < count; ++i) store(begin + i, results[i]);
      });
    });
  }

  py::object closest_hit(const py::object& origins, const py::object& directions, const py::object& t_min,
                         const py::object& t_max) const {
    const Rays rays(origins, directions, t_min, t_max);
    py::array_t<float> t(rays.shape), u(rays.shape), v(rays.shape);
    py::array_t<int64_t> primitive(rays.shape);
    py::array_t<bool> hit(rays.shape);
    trace<Hit>(rays, [t = t.mutable_data(), u = u.mutable_data(), v = v.mutable_data(),
                      primitive = primitive.mutable_data(), hit = hit.mutable_data()](size_t i, const Hit& h) {
      t[i] = h.t;
      u[i] = h.u;
      v[i] = h.v;
      primitive[i] = h ? static_cast<int64_t>(h.primitive) : -1;
      hit[i] = static_cast<bool>(h);
    });
    return py::module_::import("kerf").attr("Hits")(t, u, v, primitive, hit);
  }

  py::array_t<bool> any_hit(const py::object& origins, const py::object& directions, const py::object& t_min,
                            const py::object& t_max) const {
    const Rays rays(origins, directions, t_min, t_max);
    py::array_t<bool> hit(rays.shape);
    trace<uint8_t>(rays, [hit = hit.mutable_data()](size_t i, uint8_t h) { hit[i] = h != 0; });
    return hit;
  }

  py::array_t<float> bounds() const {
    const Box3f box = scene_.bounds();
    const std::array<Vec3f, 2> ends = {box.lower, box.upper};
    return py::array_t<float>({2, 3}, &ends[0].x);
  }

  py::dict report() const {
    using namespace py::literals;
    const BuildReport& r = scene_.report();
    return py::dict("structure"_a = r.structure, "primitives"_a = r.primitives, "invalid"_a = r.invalid,
                    "degenerate"_a = r.degenerate, "references"_a = r.references,
                    "references_per_primitive"_a = r.references_per_primitive, "sa_max"_a = r.sa_max,
                    "capped"_a = r.capped, "short_of_room"_a = r.short_of_room,
                    "split_reason"_a = r.choice ? py::object(py::str(r.choice->reason)) : py::object(py::none()),
                    "bytes"_a = r.bytes, "peak_bytes"_a = r.peak_bytes, "nodes"_a = r.nodes, "leaves"_a = r.leaves,
                    "depth"_a = r.depth, "largest_leaf"_a = r.largest_leaf, "sah_cost"_a = r.sah_cost,
                    "tree_hash"_a = r.tree_hash, "instruction_set"_a = r.instruction_set,
                    "seconds"_a = py::dict("references"_a = r.seconds.references, "split"_a = r.seconds.split,
                                           "build"_a = r.seconds.build, "optimise"_a = r.seconds.optimise,
                                           "layout"_a = r.seconds.layout, "total"_a = r.seconds.total));
  }

 private:
  py::array_t<float> vertices_;
  py::array_t<uint32_t> faces_;
  int threads_ = 0;
  Scene scene_;
};

py::list menu_list() {
  using namespace py::literals;
  py::list all;
  for (const MenuEntry& entry : menu()) {
    py::list options;
    for (const OptionSpec& spec : entry.options) {
      py::list words;
      for (const std::string_view word : spec.words) words.append(word);
      options.append(py::dict("name"_a = spec.name, "sentence"_a = spec.sentence, "default"_a = spec.fallback,
                              "least"_a = spec.least, "above_least"_a = spec.above_least, "most"_a = spec.most,
                              "whole"_a = spec.whole, "words"_a = words));
    }
    all.append(py::dict("kind"_a = entry.kind, "name"_a = entry.name, "sentence"_a = entry.sentence,
                        "source"_a = entry.source, "options"_a = options));
  }
  return all;
}

/// Makes kerf.Error, a ValueError with `code` and `place`, and turns the C++ exception into it.
void add_error(py::module_& module) {
  static py::handle type = PyErr_NewExceptionWithDoc("kerf.Error", "Bad input. `code` says what kind, `place` where.",
                                                     PyExc_ValueError, nullptr);
  module.add_object("Error", type);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const py::object made = type(error.what());
      made.attr("code") = code_name(error.code());
      made.attr("place") = error.place();
      PyErr_SetObject(type.ptr(), made.ptr());
    }
  });
}

constexpr const char* kSceneDoc =
    "Scene(vertices, faces, structure='balanced', threads=0, skip_invalid=False, refittable=False, progress=None,\n"
    "      max_bytes=None)\n\n"
    "Triangles and what finds which of them rays hit. vertices: (n, 3) numbers; faces: (m, 3) integers.\n"
    "float32 vertices and uint32 faces are looked at, not copied, and kept alive: leave them unchanged, or with\n"
    "refittable=True change them and call refit().\n"
    "progress: called from this thread with the share of the build that is done, which ends at 1, and what is being\n"
    "done, some 20 times a second; False from it cancels the build, an exception ends it. max_bytes: the most memory\n"
    "that the build may take; report['short_of_room'] names what cut less for want of it. Raises Error, a ValueError, "
    "for bad input, a build that was cancelled (code 'stopped') "
    "or\n"
    "that cannot do with max_bytes.";

constexpr const char* kRefitDoc =
    "Follows vertices that moved without a new tree; for a Scene with refittable=True. vertices: (n, 3) numbers for "
    "the\n"
    "same faces, the array given before or another, which is kept alive. Returns a dict: `growth` says how much worse "
    "the\n"
    "tree has become, `should_rebuild` that a new Scene is faster. Not while other threads query.";

constexpr const char* kClosestDoc =
    "The nearest hit of each ray in [t_min, t_max], as Hits. origins, directions: (n, 3) or (3,); t_min, t_max: "
    "numbers\n"
    "or (n,); numpy's broadcasting applies.";

}  // namespace
}  // namespace kerf::python

PYBIND11_MODULE(kerf, module) {
  using namespace kerf::python;
  const float infinity = std::numeric_limits<float>::infinity();
  module.doc() = "Kerf: finds what rays hit in triangle meshes.";
  module.attr("__version__") = kerf::kVersion;
  add_error(module);
  const py::object hits =
      py::module_::import("collections").attr("namedtuple")("Hits", "t u v primitive hit", py::arg("module") = "kerf");
  hits.attr("__doc__") =
      "One entry per ray: t (float32, inf for a miss), u and v (float32, the weights of the face's second and third\n"
      "vertex), primitive (int64, the face, -1 for a miss), hit (bool).";
  module.attr("Hits") = hits;
  module.def("menu", menu_list, "All that a structure may name: a list of dicts.");
  py::class_<MeshScene>(module, "Scene", kSceneDoc)
      .def(py::init<const py::object&, const py::object&, const std::string&, int, bool, bool, const py::object&,
                    std::optional<size_t>>(),
           py::arg("vertices"), py::arg("faces"), py::arg("structure") = kerf::kDefaultStructure,
           py::arg("threads") = 0, py::arg("skip_invalid") = false, py::arg("refittable") = false,
           py::arg("progress") = py::none(), py::arg("max_bytes") = py::none())
      .def("refit", &MeshScene::refit, py::arg("vertices"), kRefitDoc)
      .def("closest_hit", &MeshScene::closest_hit, py::arg("origins"), py::arg("directions"), py::arg("t_min") = 0.0F,
           py::arg("t_max") = infinity, kClosestDoc)
      .def("any_hit", &MeshScene::any_hit, py::arg("origins"), py::arg("directions"), py::arg("t_min") = 0.0F,
           py::arg("t_max") = infinity, "Whether each ray hits anything in [t_min, t_max]; see closest_hit().")
      .def_property_readonly("bounds", &MeshScene::bounds, "float32 (2, 3): the box around all that can be hit.")
      .def_property_readonly("report", &MeshScene::report, "What the build did, as a dict.");
}
