#pragma once

#include <utility>
#include <vector>

namespace kerf {

/// A vector, empty at first, whose memory its thread keeps for the next one. Of several at once each is its own: work
/// may begin within other work of the same thread, in a callback or while the thread waits for others.
template <class T>
class ThreadVector {
 public:
  ThreadVector() : vector_(std::move(spare())) { vector_.clear(); }
  ~ThreadVector() { spare() = std::move(vector_); }
  ThreadVector(const ThreadVector&) = delete;
  ThreadVector& operator=(const ThreadVector&) = delete;

  std::vector<T>& operator*() { return vector_; }

 private:
  static std::vector<T>& spare() {
    thread_local std::vector<T> spare;
    return spare;
  }

  std::vector<T> vector_;
};

}  // namespace kerf
