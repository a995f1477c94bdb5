#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace kerf {

/// The task back end that this build uses: "tbb" or "std".
const char* task_backend();

/// How many threads work for the caller now: those of the enclosing with_threads(), else of the caller's arena.
int thread_count();

namespace detail {
void run_parallel_for(size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data);
void run_parallel_invoke(void (*body)(void*, int), void* data);
void run_with_threads(int threads, void (*body)(void*), void* data);
}  // namespace detail

/// Calls f(begin, end) for fixed blocks of `grain` that cover [0, count); blocks may run at once and in any order.
/// Block borders do not depend on the number of threads. The first exception is rethrown here. Before each of several
/// blocks the current limit is looked at, see current_limit().
template <class F>
void parallel_for(size_t count, size_t grain, F&& f) {
  using Body = std::remove_reference_t<F>;
  detail::run_parallel_for(
      count, grain, [](void* data, size_t begin, size_t end) { (*static_cast<Body*>(data))(begin, end); },
      const_cast<void*>(static_cast<const void*>(std::addressof(f))));
}

/// Calls f() and g(), maybe at once, and returns after both; before each the current limit is looked at.
template <class F, class G>
void parallel_invoke(F&& f, G&& g) {
  struct Both {
    std::remove_reference_t<F>* f;
    std::remove_reference_t<G>* g;
  } both{std::addressof(f), std::addressof(g)};
  detail::run_parallel_invoke(
      [](void* data, int which) {
        auto& b = *static_cast<Both*>(data);
        which == 0 ? (*b.f)() : (*b.g)();
      },
      &both);
}

/// Runs f() with `threads` threads for all parallel work in it; 0 leaves the caller's arena as it is.
template <class F>
void with_threads(int threads, F&& f) {
  using Body = std::remove_reference_t<F>;
  detail::run_with_threads(
      threads, [](void* data) { (*static_cast<Body*>(data))(); },
      const_cast<void*>(static_cast<const void*>(std::addressof(f))));
}

}  // namespace kerf
