// Replaces the operators new and delete of the program by ones that count: to be included by one of its files only.

#pragma once

#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

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

namespace kerf::test {

/// The most that f() had on the heap at once, besides what was there.
template <class F>
size_t heap_peak(F&& f) {
  const size_t before = live;
  most = before;
  f();
  return most - before;
}

}  // namespace kerf::test
