#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

namespace kerf {
namespace detail {

/// Zeroed memory at the border of a cache line; from some megabytes on, on huge pages where the system offers them,
/// which spares a traversal most misses of the table of pages. Throws std::bad_alloc.
void* allocate_lines(size_t bytes);
void free_lines(void* memory, size_t bytes) noexcept;

}  // namespace detail

/// A number of plain values at the border of a cache line, zero at first; see detail::allocate_lines().
template <class T>
class LineArray {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 64);

 public:
  LineArray() = default;
  explicit LineArray(size_t count)
      : data_(count > 0 ? static_cast<T*>(detail::allocate_lines(count * sizeof(T))) : nullptr), size_(count) {}
  LineArray(const LineArray& other) : LineArray(other.size_) {
    if (size_ > 0) std::memcpy(static_cast<void*>(data_), other.data_, size_ * sizeof(T));
  }
  LineArray(LineArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  LineArray& operator=(LineArray other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~LineArray() { detail::free_lines(data_, bytes()); }

  size_t size() const { return size_; }
  size_t bytes() const { return size_ * sizeof(T); }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](size_t i) { return data_[i]; }
  const T& operator[](size_t i) const { return data_[i]; }
  std::span<const T> span() const { return {data_, size_}; }

 private:
  T* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace kerf
