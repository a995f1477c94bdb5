// kerf_bench_memory: for models straight and turned, the most that a build has on the heap at once, beside the finished
// structure and what the build says of itself. Every allocation counts, the caller's model left out.

#include <malloc.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "kerf/study/turn.h"

namespace {

std::atomic<size_t> live = 0, most = 0;

void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const size_t now = live += malloc_usable_size(memory);
  for (size_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
  }
  return memory;
}
void uncounted(void* memory) {
  live -= memory != nullptr ? malloc_usable_size(memory) : 0;
  std::free(memory);
}

}  // namespace

void* operator new(size_t size) { return counted(std::malloc(size)); }
void* operator new(size_t size, std::align_val_t alignment) {
  const auto step = static_cast<size_t>(alignment);
  return counted(std::aligned_alloc(step, (size + step - 1) / step * step));
}
void operator delete(void* memory) noexcept { uncounted(memory); }
void operator delete(void* memory, size_t) noexcept { uncounted(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { uncounted(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { uncounted(memory); }

namespace {

void measure(const std::string& name, const kerf::Mesh& mesh, const char* structure) {
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{mesh.vertices, mesh.triangles});
  const size_t before = live;
  most = before;
  const kerf::BuildReport& report = scene.build({.structure = structure, .threads = 2});
  const size_t peak = most - before;
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
