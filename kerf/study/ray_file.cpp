// Rays as NumPy arrays: https://numpy.org/neps/nep-0001-npy-format.html

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "kerf/base/error.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/output_file.h"
#include "kerf/study/study_rays.h"

namespace kerf {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::string_view kRecord =
    "[('origin', '<f4', (3,)), ('t_min', '<f4'), ('direction', '<f4', (3,)), ('t_max', '<f4'), ('mask', '<u4'), "
    "('kind', '<u4')]";
constexpr size_t kRecordBytes = 40;
constexpr size_t kAlignment = 64;  // of the data in the file, as the format asks
constexpr uint32_t kLoadedKind = 255;

[[noreturn]] void refuse(const std::string& path, const std::string& sentence) {
  throw Error(ErrorCode::file, path, sentence);
}

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if constexpr (!kLittleEndianHost) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

std::string header(size_t count) {
  std::string text =
      "{'descr': " + std::string(kRecord) + ", 'fortran_order': False, 'shape': (" + std::to_string(count) + ",), }";
  const size_t before = kMagic.size() + 4;  // the version and the length stand there too
  text.append(kAlignment - 1 - (before + text.size()) % kAlignment, ' ');
  text += '\n';
  std::string bytes(kMagic);
  bytes += '\x01';
  bytes += '\x00';
  append(bytes, static_cast<uint16_t>(text.size()));
  return bytes + text;
}

uint32_t number_of(const std::string& kind) {
  const std::span<const RayKindEntry> all = ray_kinds();
  const auto found = std::find_if(all.begin(), all.end(), [&](const RayKindEntry& e) { return e.name == kind; });
  return found == all.end() ? kLoadedKind : static_cast<uint32_t>(found - all.begin());
}

/// The header's dictionary and the data behind it.
struct Array {
  std::string_view dictionary;
  std::span<const char> data;
};

Array open_array(const std::string& path, std::span<const char> bytes) {
  const std::string_view text(bytes.data(), bytes.size());
  if (!text.starts_with(kMagic) || text.size() < 12) refuse(path, "it is not a NumPy array (.npy)");
  const bool is_long = text[6] != '\x01';  // versions 2 and 3 have a longer length
  const size_t length = is_long ? load_number<uint32_t>(text.data() + 8, !kLittleEndianHost)
                                : load_number<uint16_t>(text.data() + 8, !kLittleEndianHost);
  const size_t begin = is_long ? 12 : 10;
  if (text.size() - begin < length) refuse(path, "it is cut short in its header");
  return {text.substr(begin, length), bytes.subspan(begin + length)};
}

/// What stands behind a key of the dictionary, as far as the next key.
std::string_view value_of(const std::string& path, std::string_view dictionary, std::string_view key) {
  const size_t at = dictionary.find("'" + std::string(key) + "':");
  if (at == std::string_view::npos) refuse(path, "its header has no '" + std::string(key) + "'");
  std::string_view value = dictionary.substr(at + key.size() + 3);
  while (value.starts_with(' ')) value.remove_prefix(1);
  return value;
}

std::vector<size_t> shape_of(const std::string& path, std::string_view dictionary) {
  std::string_view text = value_of(path, dictionary, "shape");
  std::vector<size_t> shape;
  if (!text.starts_with('(')) refuse(path, "its header has no shape");
  text.remove_prefix(1);
  while (!text.empty() && text.front() != ')') {
    if (text.front() == ' ' || text.front() == ',') {
      text.remove_prefix(1);
      continue;
    }
    size_t value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc()) refuse(path, "its header has no shape");
    shape.push_back(value);
    text.remove_prefix(static_cast<size_t>(end - text.data()));
  }
  return shape;
}

void check_size(const std::string& path, const Array& array, size_t count, size_t bytes_each) {
  if (count > array.data.size() / bytes_each) refuse(path, "it is cut short");
  if (array.data.size() != count * bytes_each) refuse(path, "there are bytes behind its end");
}

std::vector<StudyRays> read_records(const std::string& path, const Array& array, size_t count) {
  check_size(path, array, count, kRecordBytes);
  std::vector<StudyRays> all;
  std::optional<uint32_t> current;
  for (size_t i = 0; i < count; ++i) {
    const char* at = array.data.data() + i * kRecordBytes;
    const auto number = [&](size_t k) { return load_number<float>(at + 4 * k, !kLittleEndianHost); };
    const auto kind = load_number<uint32_t>(at + 36, !kLittleEndianHost);
    if (kind >= ray_kinds().size() && kind != kLoadedKind) {
      refuse(path, "ray " + std::to_string(i) + " is of kind " + std::to_string(kind) + ", which does not exist");
    }
    if (current != kind) {
      const bool is_known = kind != kLoadedKind;
      all.push_back(
          {is_known ? std::string(ray_kinds()[kind].name) : "loaded", is_known && ray_kinds()[kind].any_hit, {}});
      current = kind;
    }
    Ray ray;
    ray.origin = {number(0), number(1), number(2)};
    ray.t_min = number(3);
    ray.direction = {number(4), number(5), number(6)};
    ray.t_max = number(7);
    ray.mask = load_number<uint32_t>(at + 32, !kLittleEndianHost);
    all.back().rays.push_back(ray);
  }
  return all;
}

std::vector<StudyRays> read_plain(const std::string& path, const Array& array, const std::vector<size_t>& shape,
                                  bool is_double) {
  if (shape.size() != 2 || (shape[1] != 6 && shape[1] != 8)) {
    refuse(path, "plain rays have the shape (n, 6) or (n, 8)");
  }
  const size_t width = shape[1], each = is_double ? 8 : 4;
  check_size(path, array, shape[0], width * each);
  StudyRays rays{"loaded", false, {}};
  for (size_t i = 0; i < shape[0]; ++i) {
    const auto number = [&](size_t k) {
      const char* at = array.data.data() + (i * width + k) * each;
      return is_double ? static_cast<float>(load_number<double>(at, !kLittleEndianHost))
                       : load_number<float>(at, !kLittleEndianHost);
    };
    const size_t second = width == 8 ? 4 : 3;
    Ray ray;
    ray.origin = {number(0), number(1), number(2)};
    ray.direction = {number(second), number(second + 1), number(second + 2)};
    if (width == 8) {
      ray.t_min = number(3);
      ray.t_max = number(7);
    }
    rays.rays.push_back(ray);
  }
  return {std::move(rays)};
}

}  // namespace

void save_rays(const std::string& path, std::span<const StudyRays> rays) {
  size_t count = 0;
  for (const StudyRays& kind : rays) count += kind.rays.size();
  OutputFile file(path);
  file.write(header(count));
  std::string bytes;
  for (const StudyRays& kind : rays) {
    const uint32_t number = number_of(kind.kind);
    for (const Ray& ray : kind.rays) {
      bytes.clear();
      for (const Vec3f* v : {&ray.origin, &ray.direction}) {
        for (uint32_t axis = 0; axis < 3; ++axis) append(bytes, (*v)[axis]);
        append(bytes, v == &ray.origin ? ray.t_min : ray.t_max);
      }
      append(bytes, ray.mask);
      append(bytes, number);
      file.write(bytes);
    }
  }
  file.commit();
}

std::vector<StudyRays> load_rays(const std::string& path) {
  const MappedFile file(path);
  const Array array = open_array(path, file.bytes());
  const std::vector<size_t> shape = shape_of(path, array.dictionary);
  if (!value_of(path, array.dictionary, "fortran_order").starts_with("False")) {
    refuse(path, "it is in Fortran order; save numpy.ascontiguousarray() of it");
  }
  const std::string_view type = value_of(path, array.dictionary, "descr");
  if (type.starts_with(kRecord) && shape.size() == 1) return read_records(path, array, shape[0]);
  if (type.starts_with("'<f4'")) return read_plain(path, array, shape, false);
  if (type.starts_with("'<f8'")) return read_plain(path, array, shape, true);
  refuse(path, "its numbers are neither <f4, <f8 nor the records that --save-rays writes");
}

}  // namespace kerf
