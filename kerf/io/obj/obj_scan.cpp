#include "kerf/io/obj/obj_scan.h"

#include <cstring>

#include "kerf/base/parallel.h"
#include "kerf/io/obj/obj_cursor.h"

namespace kerf {
namespace {

constexpr size_t kChunkSize = size_t{1} << 20;

/// The first place from `at` on where a statement may begin. No line before it ends with a backslash, so it is one even
/// where that backslash is part of a comment.
const char* statement_border(const char* begin, const char* at, const char* end) {
  while (at != end) {
    const void* found = std::memchr(at, '\n', static_cast<size_t>(end - at));
    if (found == nullptr) return end;
    const char* newline = static_cast<const char*>(found);
    const char* last = newline;
    if (last != begin && last[-1] == '\r') --last;
    at = newline + 1;
    if (last == begin || last[-1] != '\\') return at;
  }
  return end;
}

std::vector<ObjChunk> cut_into_chunks(std::span<const char> text) {
  std::vector<ObjChunk> chunks;
  const char* const end = text.data() + text.size();
  for (const char* begin = text.data(); begin != end;) {
    const size_t left = static_cast<size_t>(end - begin);
    ObjChunk chunk;
    chunk.begin = begin;
    chunk.end = left <= kChunkSize ? end : statement_border(begin, begin + kChunkSize, end);
    begin = chunk.end;
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

void note_use(std::string_view vertex, std::string_view number, ObjAttributeUse& use) {
  if (number.empty()) {
    use.missing = true;
    return;
  }
  use.present = true;
  // The same digits are the same number, but negative ones count from ends of their own.
  if (!use.differs) use.differs = number != vertex || vertex[0] == '-';
}

/// Notes how "v/t/n" names its attributes.
void note_corner(std::string_view corner, ObjChunk& chunk) {
  size_t slashes[2] = {corner.size(), corner.size()};
  size_t found = 0;
  for (size_t i = 0; i < corner.size() && found < 2; ++i) {
    if (corner[i] == '/') slashes[found++] = i;
  }
  const auto between = [&](size_t begin, size_t end) {
    return begin < end ? corner.substr(begin, end - begin) : std::string_view();
  };
  const std::string_view vertex = corner.substr(0, slashes[0]);
  note_use(vertex, between(slashes[0] + 1, slashes[1]), chunk.uvs);
  note_use(vertex, between(slashes[1] + 1, corner.size()), chunk.normals);
}

void scan_face(ObjCursor& cursor, ObjChunk& chunk) {
  uint64_t corners = 0;
  for (; !cursor.ends(); ++corners) note_corner(cursor.word(), chunk);
  if (corners >= 3) chunk.counts.triangles += corners - 2;
}

void scan_chunk(ObjChunk& chunk) {
  ObjCursor cursor(chunk.begin, chunk.end);
  const auto name = [&]() -> ObjName {
    const std::string_view rest = cursor.rest();
    return {rest.data(), rest, chunk.counts.triangles};
  };
  while (cursor.next_statement()) {
    switch (obj_keyword(cursor.word())) {
      case ObjKeyword::vertex:
        ++chunk.counts.vertices;
        break;
      case ObjKeyword::uv:
        ++chunk.counts.uvs;
        break;
      case ObjKeyword::normal:
        ++chunk.counts.normals;
        break;
      case ObjKeyword::face:
        scan_face(cursor, chunk);
        break;
      case ObjKeyword::material:
        chunk.materials.push_back(name());
        break;
      case ObjKeyword::library:
        chunk.libraries.push_back(name());
        break;
      case ObjKeyword::other:
        break;
    }
    cursor.skip_statement();
  }
}

ObjCounts sum(const ObjCounts& a, const ObjCounts& b) {
  return {a.vertices + b.vertices, a.uvs + b.uvs, a.normals + b.normals, a.triangles + b.triangles};
}

}  // namespace

std::vector<ObjChunk> scan_obj(std::span<const char> text) {
  std::vector<ObjChunk> chunks = cut_into_chunks(text);
  parallel_for(chunks.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) scan_chunk(chunks[i]);
  });
  for (size_t i = 1; i < chunks.size(); ++i) chunks[i].before = sum(chunks[i - 1].before, chunks[i - 1].counts);
  return chunks;
}

ObjCounts total_counts(std::span<const ObjChunk> chunks) {
  return chunks.empty() ? ObjCounts{} : sum(chunks.back().before, chunks.back().counts);
}

}  // namespace kerf
