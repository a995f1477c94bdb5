// kerf_bench_memory: for models straight and turned, the most that a build has on the heap at once, beside the finished
// structure and what the build says of itself. Every allocation counts, the caller's model left out.

#include <cstdio>
#include <string>

#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "kerf/study/turn.h"
#include "tests/support/counted_heap.h"

namespace {

void measure(const std::string& name, const kerf::Mesh& mesh, const char* structure) {
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{mesh.vertices, mesh.triangles});
  const size_t peak = kerf::test::heap_peak([&] { scene.build({.structure = structure, .threads = 2}); });
  const kerf::BuildReport& report = scene.report();
  const auto bytes = static_cast<double>(report.bytes);
  std::printf("%-22s %-30s %9zu %6.3f %7.1f %7.1f %6.2f %6.2f %016llx\n", name.c_str(), structure, report.primitives,
              report.references_per_primitive, bytes / 1e6, static_cast<double>(peak) / 1e6,
              static_cast<double>(peak) / bytes, static_cast<double>(report.peak_bytes) / bytes,
              static_cast<unsigned long long>(report.tree_hash));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("%-22s %-30s %9s %6s %7s %7s %6s %6s %s\n", "scene", "structure", "triangles", "R", "tree MB", "peak MB",
              "peak/t", "said/t", "tree");
  for (int i = 1; i < argc; ++i) {
    const std::string path = argv[i];
    const std::string name = path.substr(path.rfind('/') + 1);
    const kerf::Mesh mesh = kerf::read_ply(path);
    for (const char* turn : {"straight", "xyz"}) {
      const kerf::Mesh other = kerf::turned(mesh, kerf::turn_by_name(turn));
      for (const char* structure : {"binned_sah", "early_split(auto)+binned_sah", "fast", "balanced", "best"}) {
        measure(name + (turn[0] == 'x' ? ", xyz" : ""), other, structure);
      }
    }
  }
}
