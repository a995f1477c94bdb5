#include "kerf/io/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <type_traits>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/message.h"
#include "kerf/io/ply/ply_cursor.h"
#include "kerf/io/ply/ply_header.h"

namespace kerf {
namespace {

constexpr size_t kNone = std::numeric_limits<size_t>::max();
constexpr std::string_view kElementNames[] = {"vertex", "face", "tristrips"};

/// Which parts of the file make the mesh.
struct Roles {
  const PlyElement* vertex = nullptr;
  const PlyElement* face = nullptr;
  const PlyElement* tristrips = nullptr;
  size_t coordinate[3] = {kNone, kNone, kNone};  // properties of vertex
  size_t face_list = kNone;
  size_t tristrips_list = kNone;
};

std::vector<std::string_view> property_names(const PlyElement& element) {
  std::vector<std::string_view> names;
  for (const PlyProperty& property : element.properties) names.push_back(property.name);
  return names;
}

size_t find_property(const PlyElement& element, std::string_view name) {
  for (size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].name == name) return i;
  }
  return kNone;
}

/// Looks in the header for what makes a mesh, and refuses one in which it is missing or ambiguous.
class RoleFinder {
 public:
  RoleFinder(const PlyHeader& header, const std::string& name) : header_(header), name_(name) {}

  Roles find() const {
    Roles roles;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") roles.vertex = &element;
      if (element.name == "face") roles.face = &element;
      if (element.name == "tristrips") roles.tristrips = &element;
    }
    refuse_misspelt(roles);
    if (roles.vertex == nullptr) fail(header_.lines, "the header has no element vertex");
    for (uint32_t axis = 0; axis < 3; ++axis) {
      roles.coordinate[axis] = find_coordinate(*roles.vertex, std::string_view("xyz").substr(axis, 1));
    }
    if (roles.face != nullptr) roles.face_list = find_list(*roles.face);
    if (roles.tristrips != nullptr) roles.tristrips_list = find_list(*roles.tristrips);
    return roles;
  }

 private:
  [[noreturn]] void fail(size_t line, const std::string& sentence) const {
    throw Error(ErrorCode::file, fmt::format("{}:{}", name_, line), sentence);
  }

  /// Elements of other names are passed over, but "faces" without a face would lose the mesh without a word.
  void refuse_misspelt(const Roles& roles) const {
    const bool has_triangles = roles.face != nullptr || roles.tristrips != nullptr;
    if (roles.vertex != nullptr && has_triangles) return;
    for (const PlyElement& element : header_.elements) {
      const std::string_view meant = nearest_word(element.name, kElementNames);
      if (meant.empty() || meant == element.name) continue;
      if (meant == "vertex" ? roles.vertex != nullptr : has_triangles) continue;
      fail(element.line, fmt::format("unknown element {}; did you mean '{}'?", quoted(element.name), meant));
    }
  }

  size_t find_coordinate(const PlyElement& vertex, std::string_view name) const {
    const size_t found = find_property(vertex, name);
    if (found == kNone) {
      const std::string_view nearest = nearest_word(name, property_names(vertex));
      fail(vertex.line, fmt::format("element vertex has no property {}{}", name,
                                    nearest.empty() ? "" : fmt::format(", only {}", quoted(nearest))));
    }
    if (vertex.properties[found].count_type) {
      fail(vertex.line, fmt::format("property {} of element vertex is a list; expected a single number", name));
    }
    return found;
  }

  size_t find_list(const PlyElement& element) const {
    const size_t plural = find_property(element, "vertex_indices");
    const size_t singular = find_property(element, "vertex_index");
    const size_t found = plural != kNone ? plural : singular;
    const std::string_view name = element.name;
    if (plural != kNone && singular != kNone) {
      fail(element.line, fmt::format("element {} has both vertex_indices and vertex_index", name));
    }
    if (found == kNone && element.count > 0) {
      fail(element.line, fmt::format("element {} has no property vertex_indices or vertex_index", name));
    }
    if (found != kNone && !element.properties[found].count_type) {
      const std::string property = printable(element.properties[found].name);
      fail(element.line, fmt::format("property {} of element {} is a single number; expected a list", property, name));
    }
    return found;
  }

  const PlyHeader& header_;
  const std::string& name_;
};

/// Passes over all properties of a row in [begin, end).
template <class Cursor>
void skip_properties(Cursor& cursor, const PlyElement& element, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) cursor.skip(element.properties[i]);
}

template <class Cursor>
void skip_element(Cursor& cursor, const PlyElement& element) {
  // Rows without properties take no bytes, so no file is too short for any number of them.
  if (element.properties.empty() || cursor.skip_rows()) return;
  for (uint64_t row = 0; row < element.count; ++row) {
    cursor.begin_row(row);
    skip_properties(cursor, element, 0, element.properties.size());
    cursor.end_row();
  }
}

/// The fast path for vertices: x, y and z are floats and rows have one size. False where that is not so.
bool read_float_vertices(PlyBinaryCursor& cursor, const PlyElement& element, const size_t (&coordinate)[3],
                         std::vector<Vec3f>& vertices) {
  size_t row_size = 0;
  size_t offset[3] = {};
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.count_type) return false;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (coordinate[axis] != i) continue;
      if (property.type != PlyType::float32) return false;
      offset[axis] = row_size;
    }
    row_size += size_of(property.type);
  }
  const char* row = cursor.rest().data();
  const bool swap = cursor.swap();
  for (uint64_t i = 0; i < element.count; ++i, row += row_size) {
    vertices.push_back({load_number<float>(row + offset[0], swap), load_number<float>(row + offset[1], swap),
                        load_number<float>(row + offset[2], swap)});
  }
  cursor.advance(element.count * row_size);
  return true;
}

template <class Cursor>
void read_vertices(Cursor& cursor, const PlyElement& element, const size_t (&coordinate)[3],
                   std::vector<Vec3f>& vertices) {
  vertices.reserve(element.count);
  if constexpr (std::is_same_v<Cursor, PlyBinaryCursor>) {
    if (read_float_vertices(cursor, element, coordinate, vertices)) return;
  }
  constexpr uint32_t kSkip = 3;
  std::vector<uint32_t> axis_of(element.properties.size(), kSkip);
  for (uint32_t axis = 0; axis < 3; ++axis) axis_of[coordinate[axis]] = axis;
  for (uint64_t row = 0; row < element.count; ++row) {
    cursor.begin_row(row);
    Vec3f vertex;
    for (size_t i = 0; i < element.properties.size(); ++i) {
      if (axis_of[i] == kSkip) {
        cursor.skip(element.properties[i]);
      } else {
        vertex[axis_of[i]] = static_cast<float>(cursor.real(element.properties[i]));
      }
    }
    cursor.end_row();
    vertices.push_back(vertex);
  }
}

/// One index of a list; anything that is not a vertex of the file is an error.
template <class Cursor>
uint32_t read_index(Cursor& cursor, const PlyProperty& list, int64_t index, uint64_t vertex_count) {
  if (index < 0 || static_cast<uint64_t>(index) >= vertex_count) {
    cursor.fail(
        fmt::format("has the index {} in {}, but the file has {} vertices", index, printable(list.name), vertex_count));
  }
  return static_cast<uint32_t>(index);
}

template <class Cursor>
uint32_t read_index(Cursor& cursor, const PlyProperty& list, uint64_t vertex_count) {
  return read_index(cursor, list, cursor.integer(list), vertex_count);
}

using Triangles = std::vector<std::array<uint32_t, 3>>;

template <class Cursor>
void read_polygon(Cursor& cursor, const PlyProperty& list, uint64_t vertex_count, Triangles& triangles) {
  const uint64_t corners = cursor.list_count(list);
  if (corners < 3) cursor.fail(fmt::format("has {} corner{}; expected at least 3", corners, corners == 1 ? "" : "s"));
  const uint32_t first = read_index(cursor, list, vertex_count);
  uint32_t previous = read_index(cursor, list, vertex_count);
  for (uint64_t i = 2; i < corners; ++i) {
    const uint32_t corner = read_index(cursor, list, vertex_count);
    triangles.push_back({first, previous, corner});
    previous = corner;
  }
}

template <class Cursor>
void read_strip(Cursor& cursor, const PlyProperty& list, uint64_t vertex_count, Triangles& triangles) {
  const uint64_t length = cursor.list_count(list);
  uint32_t before = 0, previous = 0;
  uint64_t corners = 0;  // of this strip so far
  for (uint64_t i = 0; i < length; ++i) {
    const int64_t index = cursor.integer(list);
    if (index == -1) {
      corners = 0;
      continue;
    }
    const uint32_t corner = read_index(cursor, list, index, vertex_count);
    if (++corners >= 3) {
      const bool turned = corners % 2 == 0;
      triangles.push_back(turned ? std::array{previous, before, corner} : std::array{before, previous, corner});
    }
    before = previous;
    previous = corner;
  }
}

/// The fast path for faces: rows of one size as long as their lists are triangles, with a count of one byte and indices
/// of four. Knows nothing of errors: it stops at the first row that is anything else.
class PlainTriangles {
 public:
  PlainTriangles(const PlyElement& element, size_t list) {
    const PlyProperty& indices = element.properties[list];
    applies_ = size_of(*indices.count_type) == 1 && (indices.type == PlyType::int32 || indices.type == PlyType::uint32);
    for (size_t i = 0; i < element.properties.size(); ++i) {
      if (i == list) continue;
      if (element.properties[i].count_type) applies_ = false;
      (i < list ? before_ : after_) += size_of(element.properties[i].type);
    }
  }

  /// Reads at most `rows` rows and returns how many.
  uint64_t read(PlyBinaryCursor& cursor, uint64_t rows, uint64_t vertex_count, Triangles& triangles) const {
    if (!applies_) return 0;
    const size_t row_size = before_ + 13 + after_;
    const uint64_t most = std::min<uint64_t>(rows, cursor.rest().size() / row_size);
    const char* row = cursor.rest().data();
    const bool swap = cursor.swap();
    uint64_t done = 0;
    for (; done < most; ++done, row += row_size) {
      const char* list = row + before_;
      if (list[0] != 3) break;
      // Negative indices are large ones here, and so out of range in either type.
      const std::array<uint32_t, 3> corners = {load_number<uint32_t>(list + 1, swap),
                                               load_number<uint32_t>(list + 5, swap),
                                               load_number<uint32_t>(list + 9, swap)};
      if (std::max({corners[0], corners[1], corners[2]}) >= vertex_count) break;
      triangles.push_back(corners);
    }
    cursor.advance(done * row_size);
    return done;
  }

 private:
  bool applies_ = false;
  size_t before_ = 0;  // bytes of a row in front of the list
  size_t after_ = 0;
};

/// Reads all rows of `face` or `tristrips`; read_list makes triangles of one list.
template <class Cursor, class ReadList>
void read_triangles(Cursor& cursor, const PlyElement& element, size_t list, uint64_t vertex_count, Triangles& triangles,
                    ReadList read_list, bool plain_rows) {
  if (element.count == 0) return;
  const PlyProperty& indices = element.properties[list];
  triangles.reserve(triangles.size() + std::min(element.count, cursor.most_triangle_rows(indices)));
  const PlainTriangles plain(element, list);
  for (uint64_t row = 0; row < element.count; ++row) {
    if constexpr (std::is_same_v<Cursor, PlyBinaryCursor>) {
      if (plain_rows) row += plain.read(cursor, element.count - row, vertex_count, triangles);
      if (row == element.count) break;
    }
    cursor.begin_row(row);
    skip_properties(cursor, element, 0, list);
    read_list(cursor, indices, vertex_count, triangles);
    skip_properties(cursor, element, list + 1, element.properties.size());
    cursor.end_row();
  }
}

template <class Cursor>
Mesh read_body(Cursor cursor, const PlyHeader& header, const Roles& roles, const std::string& name) {
  Mesh mesh;
  const uint64_t vertex_count = roles.vertex->count;
  for (const PlyElement& element : header.elements) {
    cursor.begin(element);
    if (&element == roles.vertex) {
      if (vertex_count > std::numeric_limits<uint32_t>::max()) {
        throw Error(ErrorCode::too_large, name, fmt::format("{} vertices; at most 2^32 - 1 can be read", vertex_count));
      }
      read_vertices(cursor, element, roles.coordinate, mesh.vertices);
    } else if (&element == roles.face) {
      read_triangles(cursor, element, roles.face_list, vertex_count, mesh.triangles, read_polygon<Cursor>, true);
    } else if (&element == roles.tristrips) {
      read_triangles(cursor, element, roles.tristrips_list, vertex_count, mesh.triangles, read_strip<Cursor>, false);
    } else {
      skip_element(cursor, element);
    }
  }
  return mesh;
}

}  // namespace

Mesh parse_ply(std::span<const char> bytes, const std::string& name) {
  const PlyHeader header = parse_ply_header(bytes, name);
  const Roles roles = RoleFinder(header, name).find();
  if (header.format == PlyFormat::ascii) {
    return read_body(PlyAsciiCursor(bytes, header, name), header, roles, name);
  }
  return read_body(PlyBinaryCursor(bytes, header, name), header, roles, name);
}

Mesh read_ply(const std::string& path) {
  const MappedFile file(path);
  return parse_ply(file.bytes(), path);
}

}  // namespace kerf
