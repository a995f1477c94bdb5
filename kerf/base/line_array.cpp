#include "kerf/base/line_array.h"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace kerf::detail {
namespace {

constexpr size_t kLine = 64;
constexpr size_t kHugePage = size_t{1} << 21;
constexpr size_t kLeastHuge = 2 * kHugePage;  // below that most of a page would be wasted

}  // namespace

void* allocate_lines(size_t bytes) {
  const size_t border = bytes >= kLeastHuge ? kHugePage : kLine;
  const size_t whole = (bytes + border - 1) / border * border;
  if (whole < bytes) throw std::bad_alloc();
  void* memory = std::aligned_alloc(border, whole);
  if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  if (border == kHugePage) madvise(memory, whole, MADV_HUGEPAGE);  // a wish: it works without
#endif
  std::memset(memory, 0, whole);
  return memory;
}

void free_lines(void* memory) noexcept { std::free(memory); }

}  // namespace kerf::detail
