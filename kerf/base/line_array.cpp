#include "kerf/base/line_array.h"

#include <new>

#include "kerf/base/parallel.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace kerf::detail {
namespace {

constexpr size_t kLine = 64;
constexpr size_t kHugePage = size_t{1} << 21;
constexpr size_t kLeastHuge = 2 * kHugePage;  // below that most of a page would be wasted

std::align_val_t border_of(size_t bytes) { return std::align_val_t{bytes >= kLeastHuge ? kHugePage : kLine}; }

}  // namespace

void* allocate_lines(size_t bytes) {
  const std::align_val_t border = border_of(bytes);
  void* memory = ::operator new(bytes, border);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // A wish: it works without. The last page may be shared with what follows, so it is left as it is.
  if (border == std::align_val_t{kHugePage}) madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  parallel_for(bytes, kHugePage,
               [&](size_t begin, size_t end) { std::memset(static_cast<std::byte*>(memory) + begin, 0, end - begin); });
  return memory;
}

void free_lines(void* memory, size_t bytes) noexcept { ::operator delete(memory, border_of(bytes)); }

}  // namespace kerf::detail
