#include "kerf/io/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "kerf/base/error.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr size_t kBufferSize = size_t{1} << 16;

/// The folder part of a path, "." where it has none.
std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  if (slash == path.npos) return ".";
  return path.substr(0, slash == 0 ? 1 : slash);
}

/// The path with all links resolved, or the path itself where that is not possible.
std::string resolved(const std::string& path) {
  const std::unique_ptr<char, void (*)(void*)> real(::realpath(path.c_str(), nullptr), std::free);
  return real == nullptr ? path : std::string(real.get());
}

/// The descriptor that a path names, -1 for other paths.
int stream_number(std::string_view path) {
  constexpr std::string_view kFolder = "/dev/fd/";
  if (path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  if (!path.starts_with(kFolder)) return -1;
  path.remove_prefix(kFolder.size());
  int number = -1;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
  return error == std::errc{} && end == path.data() + path.size() ? number : -1;
}

/// A name that no other thread of this program takes; O_EXCL guards against other programs.
std::string temporary_name(const std::string& folder) {
  static std::atomic<unsigned> next = 0;
  return fmt::format("{}/.kerf-{}-{}.tmp", folder, ::getpid(), next++);
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)), target_(path_) {
  if (path_.empty() || path_.find('\0') != path_.npos) fail(ENOENT);
  struct stat about {};
  const bool exists = ::stat(path_.c_str(), &about) == 0;
  if (path_.back() == '/' || (exists && S_ISDIR(about.st_mode))) fail(EISDIR);
  if (const int stream = stream_number(path_); stream >= 0) {
    open_stream(stream);
    return;
  }
  if (exists && !S_ISREG(about.st_mode)) {
    open_direct();
    return;
  }
  if (exists) {
    // Renaming over a file only asks the folder; a file that may not be written shall not be replaced either.
    if (::access(path_.c_str(), W_OK) != 0) fail(errno);
    target_ = resolved(path_);
  }
  open_temporary(folder_of(target_));
  // Failing here only costs the permissions, not the content.
  if (exists && ::fchmod(descriptor_, about.st_mode & 0777) != 0) errno = 0;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

// A stream of this process may well be a regular file, but replacing that would leave the stream behind, and opening it
// by name would write over its start.
void OutputFile::open_stream(int stream) {
  descriptor_ = ::fcntl(stream, F_DUPFD_CLOEXEC, 0);
  if (descriptor_ < 0) fail(errno);
}

void OutputFile::open_direct() {
  do {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  } while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ < 0) fail(errno);
}

void OutputFile::open_temporary(const std::string& folder) {
  while (descriptor_ < 0) {
    std::string name = temporary_name(folder);
    descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) {
      temporary_ = std::move(name);
    } else if (errno != EEXIST && errno != EINTR) {  // EEXIST: left behind by a program that was killed
      fail(errno);
    }
  }
}

void OutputFile::write(std::string_view bytes) {
  assert(descriptor_ >= 0 && "nothing is written after commit()");
  if (buffer_.size() + bytes.size() > kBufferSize) flush();
  if (bytes.size() > kBufferSize) return write_through(bytes);
  buffer_.append(bytes);
}

void OutputFile::flush() {
  write_through(buffer_);
  buffer_.clear();
}

void OutputFile::write_through(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      write_error_ = errno;
      fail(write_error_);
    }
    bytes.remove_prefix(static_cast<size_t>(done));
  }
}

void OutputFile::close() {
  const int closing = descriptor_;
  descriptor_ = -1;
  // Network file systems say only here that the disk is full. Linux closes even where it reports an interruption.
  if (::close(closing) != 0 && errno != EINTR) fail(errno);
}

void OutputFile::commit() {
  assert(descriptor_ >= 0 && "commit() is called once");
  if (write_error_ != 0) fail(write_error_);
  flush();
  close();
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void OutputFile::fail(int error_number) const {
  switch (error_number) {
    case ENOENT:
    case ENOTDIR:
      throw Error(ErrorCode::file, path_,
                  fmt::format("cannot be written: there is no folder {}", quoted(folder_of(path_))));
    case EISDIR:
      throw Error(ErrorCode::file, path_, "cannot be written: it is a folder");
    case EACCES:
      throw Error(ErrorCode::file, path_, "may not be written (permission denied)");
    case ENOSPC:
      throw Error(ErrorCode::file, path_, "cannot be written: the disk is full");
    default:
      throw Error(ErrorCode::file, path_, "cannot be written: " + system_message(error_number));
  }
}

}  // namespace kerf
