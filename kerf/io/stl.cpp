#include "kerf/io/stl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/message.h"
#include "kerf/io/text_number.h"
#include "kerf/io/vertex_joiner.h"

namespace kerf {
namespace {

constexpr size_t kHeadSize = 84;   // 80 bytes of anything and the number of facets
constexpr size_t kFacetSize = 50;  // normal, three corners, two bytes

bool is_blank(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

// --- binary ---------------------------------------------------------------------------------------------------------

/// The number of facets that a binary file states.
uint64_t stated_facets(std::span<const char> bytes) {
  return load_number<uint32_t>(bytes.data() + 80, !kLittleEndianHost);
}

Vec3f load_vertex(const char* from) {
  constexpr bool kSwap = !kLittleEndianHost;
  return {load_number<float>(from, kSwap), load_number<float>(from + 4, kSwap), load_number<float>(from + 8, kSwap)};
}

Mesh read_binary(std::span<const char> bytes, const std::string& name) {
  Mesh mesh;
  VertexJoiner joiner(name);
  mesh.triangles.reserve(stated_facets(bytes));
  for (size_t at = kHeadSize; at < bytes.size(); at += kFacetSize) {
    const char* const corners = bytes.data() + at + 12;
    const uint32_t a = joiner.number(load_vertex(corners));
    const uint32_t b = joiner.number(load_vertex(corners + 12));
    const uint32_t c = joiner.number(load_vertex(corners + 24));
    mesh.triangles.push_back({a, b, c});
  }
  mesh.vertices = joiner.take();
  return mesh;
}

[[noreturn]] void fail_binary(std::span<const char> bytes, const std::string& name) {
  const std::string place = fmt::format("{}, byte {}", name, bytes.size());
  if (bytes.size() < kHeadSize) {
    throw Error(
        ErrorCode::file, place,
        fmt::format("is no STL: it does not begin with 'solid', and a binary one has at least {} bytes", kHeadSize));
  }
  const uint64_t facets = stated_facets(bytes);
  throw Error(
      ErrorCode::file, place,
      fmt::format("is no STL, or a damaged one: it does not begin with 'solid', and as a binary one it states {} "
                  "triangles, which take {} bytes, but the file has {}",
                  facets, kHeadSize + facets * kFacetSize, bytes.size()));
}

// --- ascii ----------------------------------------------------------------------------------------------------------

/// Reads the words of an ascii file one by one. Errors have the place "name:LINE".
class AsciiReader {
 public:
  AsciiReader(std::span<const char> bytes, const std::string& name)
      : position_(bytes.data()), end_(position_ + bytes.size()), name_(name), joiner_(name) {}

  Mesh read() {
    while (!next_word().empty()) read_solid();
    mesh_.vertices = joiner_.take();
    return std::move(mesh_);
  }

 private:
  /// The word `solid` has been read.
  void read_solid() {
    check_word("solid");
    skip_name();
    while (true) {
      constexpr std::string_view kMenu[] = {"facet", "endsolid"};
      next_word();
      if (equals_ignoring_case(word_, "endsolid")) break;
      if (!equals_ignoring_case(word_, "facet")) fail_word(kMenu);
      read_facet();
    }
    skip_name();
  }

  void read_facet() {
    expect("normal");
    for (int i = 0; i < 3; ++i) skip_normal();
    expect("outer");
    expect("loop");
    Mesh::Corners corners;
    for (uint32_t& corner : corners) {
      expect("vertex");
      const float x = read_number(), y = read_number(), z = read_number();
      corner = joiner_.number({x, y, z});
    }
    expect("endloop");
    expect("endfacet");
    mesh_.triangles.push_back(corners);
  }

  /// Empty at the end of the file.
  std::string_view next_word() {
    while (position_ != end_ && is_blank(*position_)) {
      if (*position_ == '\n') ++line_;
      ++position_;
    }
    const char* const begin = position_;
    while (position_ != end_ && !is_blank(*position_)) ++position_;
    return word_ = {begin, position_};
  }

  /// The name of a solid is the rest of its line; it may have blanks, or not be there.
  void skip_name() {
    const void* newline = std::memchr(position_, '\n', static_cast<size_t>(end_ - position_));
    position_ = newline == nullptr ? end_ : static_cast<const char*>(newline);
  }

  void expect(std::string_view expected) {
    next_word();
    check_word(expected);
  }

  void check_word(std::string_view expected) const {
    if (!equals_ignoring_case(word_, expected)) fail_word({&expected, 1});
  }

  float read_number() {
    float value = 0;
    next_word();
    if (parse_float(word_.data(), word_.data() + word_.size(), value) != word_.data() + word_.size()) fail_number();
    return value;
  }

  /// Some programs write "-1.#IND" and its like for the normal of a flat triangle.
  void skip_normal() {
    float value = 0;
    next_word();
    if (parse_float(word_.data(), word_.data() + word_.size(), value) == word_.data() + word_.size()) return;
    if (word_.find(".#") == word_.npos) fail_number();
  }

  [[noreturn]] void fail(const std::string& sentence) const {
    throw Error(ErrorCode::file, fmt::format("{}:{}", name_, line_), sentence);
  }

  [[noreturn]] void fail_number() const {
    if (word_.empty()) fail("the file is cut short: it ends where a number was expected");
    fail(fmt::format("found {} where a number was expected", quoted(word_)));
  }

  [[noreturn]] void fail_word(std::span<const std::string_view> menu) const {
    if (word_.empty()) fail(fmt::format("the file is cut short: it ends where '{}' was expected", menu.back()));
    fail(fmt::format("found {}", quoted(word_)) + suggestion(word_, menu));
  }

  const char* position_;
  const char* end_;
  size_t line_ = 1;
  std::string_view word_;  // read last
  const std::string& name_;
  VertexJoiner joiner_;
  Mesh mesh_;
};

/// The bytes from the first word on where that is `solid`, else none. A zero byte is a sign of a damaged binary file,
/// as many of those begin with this word too.
bool looks_like_ascii(std::string_view text) {
  constexpr size_t kHead = 512;
  const std::string_view head = text.substr(0, kHead);
  if (head.find('\0') != head.npos) return false;
  size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  const std::string_view word = text.substr(begin, 5);
  return equals_ignoring_case(word, "solid") && (begin + 5 == text.size() || is_blank(text[begin + 5]));
}

}  // namespace

Mesh parse_stl(std::span<const char> bytes, const std::string& name) {
  if (bytes.size() >= kHeadSize && bytes.size() == kHeadSize + stated_facets(bytes) * kFacetSize) {
    return read_binary(bytes, name);
  }
  std::string_view text(bytes.data(), bytes.size());
  if (text.empty()) throw Error(ErrorCode::file, name + ":1", "is no STL: the file is empty");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a mark that some editors put in front of UTF-8
  if (looks_like_ascii(text)) return AsciiReader({text.data(), text.size()}, name).read();
  fail_binary(bytes, name);
}

Mesh read_stl(const std::string& path) {
  const MappedFile file(path);
  return parse_stl(file.bytes(), path);
}

}  // namespace kerf
