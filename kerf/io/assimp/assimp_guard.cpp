#include "kerf/io/assimp/assimp_guard.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/message.h"

namespace {
thread_local int readings = 0;  // of this library, in this thread
}

// Assimp calls this where an assertion fails, prints and aborts. It has no handler to set before its version 5.3, but
// as a function of a shared library it may be replaced. Where the linker finds Assimp's own first, that remains.
namespace Assimp {  // NOLINT: its name, as is that of the function
[[gnu::weak]] void aiAssertViolation(const char* condition, const char* file, int line);  // NOLINT

void aiAssertViolation(const char* condition, const char* file, int line) {
  if (readings > 0) throw std::runtime_error(fmt::format("{}:{}: not so: {}", file, line, condition));
  using Original = void (*)(const char*, const char*, int);
  constexpr const char* kName = "_ZN6Assimp17aiAssertViolationEPKcS1_i";
  if (const auto original = reinterpret_cast<Original>(::dlsym(RTLD_NEXT, kName))) original(condition, file, line);
  std::abort();  // it was called by someone else, who expects this
}
}  // namespace Assimp

namespace kerf {
namespace {

/// Assimp takes any STEP file for a building. One of a CAD part has curved surfaces, of which it would show none.
void check_step(std::string_view text, const std::string& path) {
  constexpr size_t kFirst = 256, kHeader = size_t{1} << 16;
  if (text.substr(0, kFirst).find("ISO-10303-21") == std::string_view::npos) return;
  const std::string_view header = text.substr(0, kHeader);
  const size_t schema = header.find("FILE_SCHEMA");
  const size_t begin = schema == std::string_view::npos ? schema : header.find('\'', schema);
  if (begin == std::string_view::npos) return;
  const std::string_view name = header.substr(begin + 1, header.find('\'', begin + 1) - begin - 1);
  if (equals_ignoring_case(name.substr(0, 3), "ifc")) return;
  throw Error(
      ErrorCode::file, path,
      fmt::format("is a STEP file of schema {}, a part with curved surfaces (B-rep), which cannot be read; save "
                  "it as triangles, such as STL or glTF",
                  kerf::quoted(name)));
}

/// Assimp takes memory for as many vertices and faces as an OFF file says.
void check_off(std::string_view text, const std::string& path) {
  constexpr std::string_view kSpace = " \t\r\n";
  int numbers = 0;
  for (size_t at = 0; at < text.size() && numbers < 3;) {
    at = text.find_first_not_of(kSpace, at);
    if (at == std::string_view::npos) return;
    if (text[at] == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    const size_t end = std::min(text.find_first_of(kSpace, at), text.size());
    const std::string_view word = text.substr(at, end - at);
    at = end;
    double count = 0;
    if (std::from_chars(word.data(), word.data() + word.size(), count).ec != std::errc()) {
      if (numbers > 0) return;
      continue;  // the name of the format
    }
    ++numbers;
    if (count > static_cast<double>(text.size())) {
      throw Error(ErrorCode::file, path,
                  fmt::format("counts {} vertices or faces, and has {} bytes", count, text.size()));
    }
  }
}

}  // namespace

AssimpAssertions::AssimpAssertions() { ++readings; }
AssimpAssertions::~AssimpAssertions() { --readings; }

void check_for_assimp(std::span<const char> bytes, const std::string& path) {
  const std::string_view text(bytes.data(), bytes.size());
  check_step(text, path);
  const size_t point = path.rfind('.');
  if (point != std::string::npos && equals_ignoring_case(std::string_view(path).substr(point), ".off")) {
    check_off(text, path);
  }
}

}  // namespace kerf
