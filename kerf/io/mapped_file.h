#pragma once

#include <span>
#include <string>
#include <vector>

namespace kerf {

/// The content of a file, read-only. A regular file is mapped, so only what is looked at is read and nothing is
/// copied; anything else (a pipe, /dev/stdin) is read to its end. A mapped file must not be shortened by others
/// while it is in use: the system ends a program that touches the lost part.
class MappedFile {
 public:
  /// Throws Error (file) with the path as place: not there, a folder, not readable.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Valid while this object lives.
  std::span<const char> bytes() const { return bytes_; }

 private:
  std::span<const char> bytes_;
  void* mapping_ = nullptr;
  std::vector<char> copy_;  // what could not be mapped
};

}  // namespace kerf
