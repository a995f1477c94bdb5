#include "kerf/io/obj/obj_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/base/parallel.h"
#include "kerf/geometry/hit.h"
#include "kerf/io/message.h"
#include "kerf/io/obj/obj_attributes.h"
#include "kerf/io/obj/obj_cursor.h"

namespace kerf {
namespace {

/// What is passed over, and what is said about it.
enum PassedOver : uint8_t { kSilent, kLines, kFreeForm, kTextureMaps, kCommands, kPassedOverCount };

constexpr std::string_view kNotes[kPassedOverCount] = {
    "", "points and lines (p, l) are not shown", "free-form curves and surfaces are not shown",
    "texture maps of the old kind (maplib, usemap) are not shown", "call and csh are not carried out"};

struct Keyword {
  std::string_view word;
  PassedOver kind;
};

constexpr Keyword kPassedOver[] = {{"g", kSilent},           {"s", kSilent},          {"o", kSilent},
                                   {"mg", kSilent},          {"l", kLines},           {"p", kLines},
                                   {"vp", kSilent},          {"cstype", kSilent},     {"deg", kSilent},
                                   {"bmat", kSilent},        {"step", kSilent},       {"curv", kFreeForm},
                                   {"curv2", kFreeForm},     {"surf", kFreeForm},     {"parm", kSilent},
                                   {"trim", kSilent},        {"hole", kSilent},       {"scrv", kSilent},
                                   {"sp", kSilent},          {"end", kSilent},        {"con", kSilent},
                                   {"bevel", kSilent},       {"c_interp", kSilent},   {"d_interp", kSilent},
                                   {"lod", kSilent},         {"shadow_obj", kSilent}, {"trace_obj", kSilent},
                                   {"ctech", kSilent},       {"stech", kSilent},      {"res", kSilent},
                                   {"bsp", kFreeForm},       {"bzp", kFreeForm},      {"cdc", kFreeForm},
                                   {"cdp", kFreeForm},       {"call", kCommands},     {"csh", kCommands},
                                   {"maplib", kTextureMaps}, {"usemap", kTextureMaps}};

[[noreturn]] void fail_keyword(std::string_view word) {
  std::vector<std::string_view> menu = {"v", "vt", "vn", "f", "usemtl", "mtllib"};
  for (const Keyword& known : kPassedOver) menu.push_back(known.word);
  const std::string_view nearest = nearest_word(word, menu);
  throw ObjFault{word.data(), fmt::format("unknown keyword {}{}", quoted(word),
                                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest))};
}

/// One corner of a face; kNone for attributes that it does not name.
struct Corner {
  uint32_t vertex, uv, normal;
};

/// Reads one chunk into its place in the mesh, of which all arrays have their full size.
class ChunkReader {
 public:
  ChunkReader(const ObjChunk& chunk, const ObjCounts& total, Mesh& mesh)
      : cursor_(chunk.begin, chunk.end), total_(total), mesh_(mesh), next_(chunk.before), end_(chunk.before) {
    end_.vertices += chunk.counts.vertices;
    end_.uvs += chunk.counts.uvs;
    end_.normals += chunk.counts.normals;
    end_.triangles += chunk.counts.triangles;
  }

  /// Returns the kinds of what was passed over, as bits.
  uint32_t read() {
    while (cursor_.next_statement()) {
      const std::string_view word = cursor_.word();
      switch (obj_keyword(word)) {
        case ObjKeyword::vertex:
          read_vertex();
          break;
        case ObjKeyword::uv:
          read_uv();
          break;
        case ObjKeyword::normal:
          read_normal();
          break;
        case ObjKeyword::face:
          read_face();
          break;
        case ObjKeyword::material:  // without a name it means the default one
          cursor_.skip_statement();
          break;
        case ObjKeyword::library:
          if (cursor_.rest().empty()) cursor_.fail_missing("the name of a material library");
          break;
        case ObjKeyword::other:
          note(word);
          cursor_.skip_statement();
          break;
      }
    }
    return passed_over_;
  }

 private:
  void note(std::string_view word) {
    for (const Keyword& known : kPassedOver) {
      if (known.word != word) continue;
      passed_over_ |= 1U << known.kind;
      return;
    }
    fail_keyword(word);
  }

  /// The place of the next element; both passes count alike, but a mistake in that must not write anywhere else.
  template <class T>
  T& place(std::vector<T>& elements, uint64_t& next, uint64_t end) {
    if (next >= end)
      throw ObjFault{cursor_.position(), "was counted otherwise than it is read; this is a fault of Kerf"};
    return elements[next++];
  }

  void read_vertex() {
    Vec3f& vertex = place(mesh_.vertices, next_.vertices, end_.vertices);
    vertex.x = cursor_.number("the x of a vertex");
    vertex.y = cursor_.number("the y of a vertex");
    vertex.z = cursor_.number("the z of a vertex");
    if (cursor_.ends()) return;
    const char* more = cursor_.position();
    int count = 0;  // of a weight, a colour, or both
    for (; !cursor_.ends(); ++count) cursor_.number("a number of a vertex");
    if (count == 2 || count > 4) {
      throw ObjFault{
          more, fmt::format("a vertex has {} numbers; 3 were expected, and maybe a weight and a colour", count + 3)};
    }
  }

  void read_uv() {
    std::array<float, 2>& uv = place(mesh_.uvs, next_.uvs, end_.uvs);
    uv[0] = cursor_.number("the u of a texture coordinate");
    uv[1] = cursor_.ends() ? 0 : cursor_.number("the v of a texture coordinate");
    if (!cursor_.ends()) cursor_.number("the w of a texture coordinate");
    cursor_.expect_end("a texture coordinate");
  }

  void read_normal() {
    Vec3f& normal = place(mesh_.normals, next_.normals, end_.normals);
    normal.x = cursor_.number("the x of a normal");
    normal.y = cursor_.number("the y of a normal");
    normal.z = cursor_.number("the z of a normal");
    cursor_.expect_end("a normal");
  }

  void read_face() {
    const char* statement = cursor_.position();
    Corner first{}, previous{};
    uint64_t corners = 0;
    for (; !cursor_.ends(); ++corners) {
      const char* at = cursor_.position();
      const Corner corner = read_corner();
      if (corners == 0) first = corner;
      check_form(first, corner, at);
      if (corners >= 2) add_triangle(first, previous, corner);
      previous = corner;
    }
    if (corners < 3) {
      throw ObjFault{statement,
                     fmt::format("a face has {} corner{}; at least 3 were expected", corners, corners == 1 ? "" : "s")};
    }
  }

  void add_triangle(const Corner& a, const Corner& b, const Corner& c) {
    const uint64_t triangle = next_.triangles;
    place(mesh_.triangles, next_.triangles, end_.triangles) = {a.vertex, b.vertex, c.vertex};
    if (!mesh_.uv_corners.empty()) mesh_.uv_corners[triangle] = {a.uv, b.uv, c.uv};
    if (!mesh_.normal_corners.empty()) mesh_.normal_corners[triangle] = {a.normal, b.normal, c.normal};
  }

  /// All corners of a face name the same attributes.
  static void check_form(const Corner& first, const Corner& corner, const char* at) {
    const bool uv = corner.uv != kNone, normal = corner.normal != kNone;
    if (uv != (first.uv != kNone)) {
      throw ObjFault{at, uv ? "this corner has a texture coordinate, but the first of the face has none"
                            : "this corner has no texture coordinate, but the first of the face has one"};
    }
    if (normal != (first.normal != kNone)) {
      throw ObjFault{at, normal ? "this corner has a normal, but the first of the face has none"
                                : "this corner has no normal, but the first of the face has one"};
    }
  }

  Corner read_corner() {
    word_ = cursor_.position();
    Corner corner{read_index(next_.vertices, total_.vertices, "vertex", "vertices"), kNone, kNone};
    if (skip_slash()) {
      if (!at_slash()) corner.uv = read_index(next_.uvs, total_.uvs, "texture coordinate", "texture coordinates");
      if (skip_slash()) corner.normal = read_index(next_.normals, total_.normals, "normal", "normals");
    }
    if (!cursor_.word_ends()) fail_corner();
    return corner;
  }

  bool at_slash() const { return cursor_.position() != cursor_.end() && *cursor_.position() == '/'; }

  bool skip_slash() {
    if (!at_slash()) return false;
    cursor_.move_to(cursor_.position() + 1);
    return true;
  }

  [[noreturn]] void fail_corner() { cursor_.fail_word(word_, "a corner such as 1, 1/2, 1//3 or 1/2/3"); }

  /// `before` elements stand above this line; negative numbers count back from there.
  uint32_t read_index(uint64_t before, uint64_t total, const char* singular, const char* plural) {
    constexpr uint64_t kMost = uint64_t{1} << 40;  // beyond all that there can be
    const char* p = cursor_.position();
    const char* const end = cursor_.end();
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) ++p;
    uint64_t number = 0;
    const char* const digits = p;
    for (; p != end && '0' <= *p && *p <= '9'; ++p) {
      if (number < kMost) number = number * 10 + static_cast<uint64_t>(*p - '0');
    }
    if (p == digits) fail_corner();
    cursor_.move_to(p);
    if (number == 0) {
      throw ObjFault{word_, fmt::format("the {} 0 of a face is none: they count from 1, or back from -1", singular)};
    }
    if (number > (negative ? before : total)) {
      const std::string there = negative ? fmt::format("{} {} above it", before, before == 1 ? "stands" : "stand")
                                         : fmt::format("the file has {} {}", total, total == 1 ? singular : plural);
      throw ObjFault{word_, fmt::format("a face has the {} {}{}, but {}", singular, negative ? "-" : "",
                                        printable({digits, p}), there)};
    }
    return static_cast<uint32_t>(negative ? before - number : number - 1);
  }

  ObjCursor cursor_;
  const ObjCounts& total_;
  Mesh& mesh_;
  ObjCounts next_;              // where the next of each goes
  ObjCounts end_;               // where the next chunk's begin
  const char* word_ = nullptr;  // the corner that is being read
  uint32_t passed_over_ = 0;
};

ObjAttributeUse joined_use(std::span<const ObjChunk> chunks, ObjAttributeUse ObjChunk::*attribute) {
  ObjAttributeUse joined;
  for (const ObjChunk& chunk : chunks) {
    const ObjAttributeUse& use = chunk.*attribute;
    joined = {joined.present || use.present, joined.missing || use.missing, joined.differs || use.differs};
  }
  return joined;
}

void check_counts(const ObjCounts& total, const std::string& name) {
  constexpr uint64_t kMost = std::numeric_limits<uint32_t>::max();
  const std::pair<uint64_t, const char*> counts[] = {
      {total.vertices, "vertices"}, {total.uvs, "texture coordinates"}, {total.normals, "normals"}};
  for (const auto& [count, what] : counts) {
    if (count <= kMost) continue;
    throw Error(ErrorCode::too_large, name, fmt::format("{} {}; at most 2^32 - 1 can be read", count, what));
  }
}

/// Gives back the array of corners where the vertices' own numbers serve as well, which takes an attribute for each
/// vertex, and the attribute where no face has it.
template <class T>
void drop_needless(const Mesh& mesh, const ObjAttributeUse& use, std::vector<T>& values,
                   std::vector<Mesh::Corners>& corners) {
  if (!use.present) values = {};
  if (values.size() == mesh.vertices.size() && corners == mesh.triangles) corners = {};
}

}  // namespace

Mesh read_obj_geometry(std::span<const char> text, std::span<const ObjChunk> chunks, const std::string& name,
                       std::vector<std::string>& notes) {
  const ObjCounts total = total_counts(chunks);
  check_counts(total, name);
  const ObjAttributeUse uvs = joined_use(chunks, &ObjChunk::uvs), normals = joined_use(chunks, &ObjChunk::normals);
  const auto needs_corners = [&](const ObjAttributeUse& use, uint64_t count) {
    return use.present && (use.missing || use.differs || count != total.vertices);
  };
  Mesh mesh;
  mesh.vertices.resize(total.vertices);
  mesh.uvs.resize(total.uvs);
  mesh.normals.resize(total.normals);
  mesh.triangles.resize(total.triangles);
  if (needs_corners(uvs, total.uvs)) mesh.uv_corners.resize(total.triangles);
  if (needs_corners(normals, total.normals)) mesh.normal_corners.resize(total.triangles);

  std::vector<std::optional<ObjFault>> faults(chunks.size());
  std::vector<uint32_t> passed_over(chunks.size());
  parallel_for(chunks.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      try {
        passed_over[i] = ChunkReader(chunks[i], total, mesh).read();
      } catch (ObjFault& fault) {
        faults[i] = std::move(fault);  // the first in the file is reported, not the first in time
      }
    }
  });
  for (const auto& fault : faults) {
    if (fault) throw obj_error(text, name, *fault);
  }
  uint32_t all = 0;
  for (const uint32_t bits : passed_over) all |= bits;
  for (uint32_t kind = kLines; kind < kPassedOverCount; ++kind) {
    if ((all >> kind & 1U) != 0) notes.emplace_back(kNotes[kind]);
  }
  drop_needless(mesh, uvs, mesh.uvs, mesh.uv_corners);
  drop_needless(mesh, normals, mesh.normals, mesh.normal_corners);
  drop_unusable_attributes(mesh, notes);
  return mesh;
}

}  // namespace kerf
