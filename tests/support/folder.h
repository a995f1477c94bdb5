// A folder of its own for a test.

#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace kerf::test {

/// A new, empty folder, removed with all that is in it. In memory where there is such a place: tests that write a
/// thousand damaged files should not wait for a disk.
class Folder {
 public:
  Folder() {
    static std::atomic<int> count{0};
    const char* memory = "/dev/shm/";
    path_ = (::access(memory, W_OK | X_OK) == 0 ? memory : testing::TempDir()) + "kerf_test." +
            std::to_string(::getpid()) + "." + std::to_string(count++);
    std::filesystem::create_directory(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return path_ + "/" + name; }

  /// Writes a file, and gives its path.
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  size_t count() const {
    const std::filesystem::directory_iterator files(path_);
    return static_cast<size_t>(std::distance(begin(files), end(files)));
  }

 private:
  std::string path_;
};

inline std::string content_of(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace kerf::test
