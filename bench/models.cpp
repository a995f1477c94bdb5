// kerf_bench_models: how long Kerf's own readers take for a model of a million triangles, and how much memory, beside
// Assimp where that is there. Each load runs in a process of its own, so that the peak of its memory is its own; the
// two readers take turns, and medians are printed. The files have just been written, so none is read from a disk. The
// peak holds the pages of a file that is mapped, too, which the system takes back when it needs them.

#include <fmt/core.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/io/model.h"

#ifdef KERF_HAVE_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace kerf::test {
namespace {

struct Arguments {
  uint64_t triangles = 1000000;
  int repeats = 5;
  std::string json;
};

// --- the files ------------------------------------------------------------------------------------------------------

/// A square of bumps: (side + 1)^2 vertices, row by row.
class Grid {
 public:
  explicit Grid(uint64_t triangles)
      : side_(std::max<uint64_t>(1, static_cast<uint64_t>(std::sqrt(static_cast<double>(triangles) / 2)))) {}

  uint64_t vertices() const { return (side_ + 1) * (side_ + 1); }
  uint64_t triangles() const { return 2 * side_ * side_; }

  Vec3f vertex(uint64_t i) const {
    const auto step = 10 / static_cast<double>(side_);
    const uint64_t column = i % (side_ + 1), row = i / (side_ + 1);
    const double x = static_cast<double>(column) * step, y = static_cast<double>(row) * step;
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(std::sin(3 * x) * std::cos(2 * y))};
  }

  std::array<uint32_t, 3> triangle(uint64_t i) const {
    const uint64_t cell = i / 2, corner = cell / side_ * (side_ + 1) + cell % side_;
    const auto at = [&](uint64_t x, uint64_t y) { return static_cast<uint32_t>(corner + x + y * (side_ + 1)); };
    return i % 2 == 0 ? std::array{at(0, 0), at(1, 0), at(1, 1)} : std::array{at(0, 0), at(1, 1), at(0, 1)};
  }

 private:
  uint64_t side_;
};

template <class T>
void put(std::ostream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_ply(std::ostream& file, const Grid& grid, bool is_ascii) {
  file << "ply\nformat " << (is_ascii ? "ascii" : "binary_little_endian") << " 1.0\nelement vertex " << grid.vertices()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << grid.triangles()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (uint64_t i = 0; i < grid.vertices(); ++i) {
    const Vec3f v = grid.vertex(i);
    is_ascii ? void(file << fmt::format("{:.6f} {:.6f} {:.6f}\n", v.x, v.y, v.z)) : put(file, v);
  }
  for (uint64_t i = 0; i < grid.triangles(); ++i) {
    const auto t = grid.triangle(i);
    if (is_ascii) {
      file << fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    } else {
      put(file, uint8_t{3});
      put(file, t);
    }
  }
}

/// With attributes, normals have the numbers of their vertices, and texture coordinates have others.
void write_obj(std::ostream& file, const Grid& grid, bool has_attributes) {
  file << "# made for a measurement\no grid\n";
  for (uint64_t i = 0; i < grid.vertices(); ++i) {
    const Vec3f v = grid.vertex(i);
    file << fmt::format("v {:.6f} {:.6f} {:.6f}\n", v.x, v.y, v.z);
  }
  if (has_attributes) {
    file << "vt 0.5 0.5\n";
    for (uint64_t i = 0; i < grid.vertices(); ++i) {
      const Vec3f v = grid.vertex(i);
      file << fmt::format("vt {:.6f} {:.6f}\nvn {:.4f} {:.4f} {:.4f}\n", v.x / 10, v.y / 10, v.z / 2, v.z / 3, 0.8);
    }
  }
  for (uint64_t i = 0; i < grid.triangles(); ++i) {
    const auto t = grid.triangle(i);
    if (has_attributes) {
      file << fmt::format("f {0}/{1}/{0} {2}/{3}/{2} {4}/{5}/{4}\n", t[0] + 1, t[0] + 2, t[1] + 1, t[1] + 2, t[2] + 1,
                          t[2] + 2);
    } else {
      file << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
  }
}

void write_stl(std::ostream& file, const Grid& grid) {
  file << std::string(80, ' ');
  put(file, static_cast<uint32_t>(grid.triangles()));
  for (uint64_t i = 0; i < grid.triangles(); ++i) {
    put(file, Vec3f{0, 0, 1});
    for (const uint32_t corner : grid.triangle(i)) put(file, grid.vertex(corner));
    put(file, uint16_t{0});
  }
}

struct ModelFile {
  std::string name, file;
  std::function<void(std::ostream&, const Grid&)> write;
};

std::vector<ModelFile> model_files() {
  return {{"PLY binary", "binary.ply", [](std::ostream& file, const Grid& grid) { write_ply(file, grid, false); }},
          {"PLY ascii", "ascii.ply", [](std::ostream& file, const Grid& grid) { write_ply(file, grid, true); }},
          {"OBJ", "plain.obj", [](std::ostream& file, const Grid& grid) { write_obj(file, grid, false); }},
          {"OBJ v/t/n", "full.obj", [](std::ostream& file, const Grid& grid) { write_obj(file, grid, true); }},
          {"STL binary", "binary.stl", write_stl}};
}

// --- measuring ------------------------------------------------------------------------------------------------------

/// What one load has taken.
struct Load {
  double seconds = 0;
  uint64_t triangles = 0, mesh_bytes = 0;
  uint64_t peak_bytes = 0;
};

/// Runs `work` in a process of its own.
Load in_child(const std::function<Load()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) throw Error(ErrorCode::file, "pipe", "cannot be made");
  const pid_t child = ::fork();
  if (child == 0) {
    int status = 1;
    try {
      const Load load = work();
      if (::write(ends[1], &load, sizeof load) == sizeof load) status = 0;
    } catch (const std::exception& error) {
      fmt::print(stderr, "kerf_bench_models: {}\n", error.what());
    }
    ::_exit(status);
  }
  ::close(ends[1]);
  Load load;
  const bool is_whole = child > 0 && ::read(ends[0], &load, sizeof load) == sizeof load;
  ::close(ends[0]);
  int status = 0;
  rusage usage{};
  if (child < 0 || ::wait4(child, &status, 0, &usage) != child || status != 0 || !is_whole) {
    throw Error(ErrorCode::file, "child", "has not done its work");
  }
  load.peak_bytes = static_cast<uint64_t>(usage.ru_maxrss) * 1024;
  return load;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class T>
uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

Load load_with_kerf(const std::string& path) {
  const auto start = std::chrono::steady_clock::now();
  const Model model = read_model(path);
  const double seconds = seconds_since(start);
  const Mesh& mesh = model.mesh;
  return {seconds, mesh.triangles.size(),
          bytes_of(mesh.vertices) + bytes_of(mesh.triangles) + bytes_of(mesh.normals) + bytes_of(mesh.normal_corners) +
              bytes_of(mesh.uvs) + bytes_of(mesh.uv_corners) + bytes_of(mesh.materials)};
}

#ifdef KERF_HAVE_ASSIMP
Load load_with_assimp(const std::string& path) {
  const auto start = std::chrono::steady_clock::now();
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  const double seconds = seconds_since(start);
  if (scene == nullptr) throw Error(ErrorCode::file, path, importer.GetErrorString());
  uint64_t triangles = 0;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) triangles += scene->mMeshes[i]->mNumFaces;
  return {seconds, triangles, 0};
}
constexpr bool kHaveAssimp = true;
#else
Load load_with_assimp(const std::string&) { return {}; }
constexpr bool kHaveAssimp = false;
#endif

/// The medians of several loads.
Load median(std::vector<Load> loads) {
  const auto middle = [&](auto member) {
    std::sort(loads.begin(), loads.end(), [&](const Load& a, const Load& b) { return a.*member < b.*member; });
    return loads[loads.size() / 2].*member;
  };
  Load result = loads[0];
  result.seconds = middle(&Load::seconds);
  result.peak_bytes = middle(&Load::peak_bytes);
  return result;
}

double megabytes(uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

nlohmann::ordered_json measure(const ModelFile& model, const std::string& path, int repeats) {
  std::vector<Load> kerf_loads, assimp_loads;
  const uint64_t baseline = in_child([] { return Load{}; }).peak_bytes;
  for (int i = 0; i < repeats; ++i) {
    kerf_loads.push_back(in_child([&] { return load_with_kerf(path); }));
    if (kHaveAssimp) assimp_loads.push_back(in_child([&] { return load_with_assimp(path); }));
  }
  const auto above_baseline = [&](const Load& load) { return load.peak_bytes - std::min(load.peak_bytes, baseline); };
  const Load kerf = median(kerf_loads);
  const uint64_t file_bytes = std::filesystem::file_size(path);
  nlohmann::ordered_json row = {{"format", model.name},
                                {"file_bytes", file_bytes},
                                {"triangles", kerf.triangles},
                                {"seconds_kerf", kerf.seconds},
                                {"peak_bytes_kerf", above_baseline(kerf)},
                                {"mesh_bytes", kerf.mesh_bytes}};
  fmt::print("{:<11} {:>8.1f} {:>10} {:>10.3f} ", model.name, megabytes(file_bytes), kerf.triangles, kerf.seconds);
  if (kHaveAssimp) {
    const Load assimp = median(assimp_loads);
    row.update({{"seconds_assimp", assimp.seconds}, {"peak_bytes_assimp", above_baseline(assimp)}});
    fmt::print("{:>10.3f} {:>9.1f} {:>9.1f}", assimp.seconds, megabytes(above_baseline(kerf)),
               megabytes(above_baseline(assimp)));
  } else {
    fmt::print("{:>10} {:>9.1f} {:>9}", "-", megabytes(above_baseline(kerf)), "-");
  }
  fmt::print(" {:>8.1f}\n", megabytes(kerf.mesh_bytes));
  std::fflush(stdout);
  return row;
}

int run(const Arguments& arguments) {
  const Grid grid(arguments.triangles);
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("kerf_bench_models.{}.", ::getpid())).string();
  fmt::print("{:<11} {:>8} {:>10} {:>10} {:>10} {:>9} {:>9} {:>8}\n", "format", "file MB", "triangles", "Kerf s",
             "Assimp s", "Kerf MB", "Assimp MB", "mesh MB");
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ModelFile& model : model_files()) {
    const std::string file = path + model.file;
    in_child([&] {  // so that this process stays small, and so those that measure
      std::ofstream stream(file, std::ios::binary);
      model.write(stream, grid);
      stream.close();
      if (!stream) throw Error(ErrorCode::file, file, "cannot be written");
      return Load{};
    });
    try {
      json.push_back(measure(model, file, arguments.repeats));
    } catch (...) {
      std::filesystem::remove(file);
      throw;
    }
    std::filesystem::remove(file);
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << json.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace kerf::test

int main(int argc, char** argv) {
  kerf::test::Arguments arguments;
  CLI::App app("Measures the time and the memory that reading a model takes, with Kerf and with Assimp.");
  app.footer("Example: kerf_bench_models --triangles 1000000 --repeats 5 --json models.json");
  app.add_option("--triangles", arguments.triangles, "About how many triangles the models have")
      ->check(CLI::Range(2, 500000000))
      ->capture_default_str();
  app.add_option("--repeats", arguments.repeats, "Rounds of alternating loads")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--json", arguments.json, "Write the table to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return kerf::test::run(arguments);
  } catch (const kerf::Error& error) {
    fmt::print(stderr, "kerf_bench_models: {}\n", error.what());
    return 1;
  }
}
