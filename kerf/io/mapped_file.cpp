#include "kerf/io/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "kerf/base/error.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

[[noreturn]] void fail(const std::string& path, int error_number) {
  switch (error_number) {
    case ENOENT:
      throw Error(ErrorCode::file, path, "there is no such file");
    case EISDIR:
      throw Error(ErrorCode::file, path, "is a folder; a file was expected");
    case EACCES:
      throw Error(ErrorCode::file, path, "may not be read (permission denied)");
    default:
      throw Error(ErrorCode::file, path, "cannot be read: " + system_message(error_number));
  }
}

class Descriptor {
 public:
  explicit Descriptor(const std::string& path) {
    do {
      number_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    } while (number_ < 0 && errno == EINTR);
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_ = -1;
};

std::vector<char> read_to_end(const Descriptor& file, const std::string& path) {
  constexpr size_t kBlock = size_t{1} << 16;
  std::vector<char> content;
  size_t used = 0;
  while (true) {
    if (content.size() - used < kBlock) content.resize(content.size() * 2 + kBlock);
    const ssize_t got = ::read(file.number(), content.data() + used, content.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, errno);
    if (got == 0) break;
    used += static_cast<size_t>(got);
  }
  content.resize(used);
  return content;
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  if (path.find('\0') != std::string::npos) fail(path, ENOENT);
  const Descriptor file(path);
  struct stat about {};
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) fail(path, errno);
  if (S_ISDIR(about.st_mode)) fail(path, EISDIR);
  // Files of /proc say that they are regular and of size 0: they are read like a pipe, as an empty file is.
  if (S_ISREG(about.st_mode) && about.st_size > 0) {
    const auto size = static_cast<size_t>(about.st_size);
    void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number(), 0);
    if (mapping != MAP_FAILED) {
      ::madvise(mapping, size, MADV_SEQUENTIAL);  // advice: a refusal changes nothing
      mapping_ = mapping;
      bytes_ = {static_cast<const char*>(mapping), size};
      return;
    }
  }
  copy_ = read_to_end(file, path);
  bytes_ = copy_;
}

MappedFile::~MappedFile() {
  if (mapping_ != nullptr) ::munmap(mapping_, bytes_.size());
}

}  // namespace kerf
