#include "kerf/io/image_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>

#include "kerf/base/error.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// The words of text in front of the pixels.
class PfmHeader {
 public:
  PfmHeader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  std::string_view word() {
    while (at_ < bytes_.size() && is_space(bytes_[at_])) {
      if (bytes_[at_++] == '\n') ++line_;
    }
    const size_t begin = at_;
    while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
    return bytes_.substr(begin, at_ - begin);
  }

  template <class T>
  T number(const char* what) {
    const std::string_view text = word();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) {
      fail(fmt::format("found {} where {} was expected", quoted(text), what));
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& sentence) const {
    throw Error(ErrorCode::file, fmt::format("{}:{}", path_, line_), sentence);
  }

  /// Where the pixels begin: after the line end, which is one byte or a carriage return and a line feed.
  size_t end() const {
    if (bytes_.substr(at_).starts_with("\r\n")) return at_ + 2;
    return std::min(at_ + 1, bytes_.size());
  }

 private:
  std::string_view bytes_;
  const std::string& path_;
  size_t at_ = 0;
  size_t line_ = 1;
};

}  // namespace

Image read_pfm(const std::string& path) {
  const MappedFile file(path);
  const std::string_view bytes(file.bytes().data(), file.bytes().size());
  PfmHeader header(bytes, path);
  const std::string_view magic = header.word();
  if (magic != "PF" && magic != "Pf") {
    header.fail(fmt::format("is not a PFM: found {} where it must begin with 'PF' or 'Pf'", quoted(magic)));
  }
  Image image{.channels = magic == "PF" ? 3U : 1U};
  image.width = header.number<uint32_t>("the width");
  image.height = header.number<uint32_t>("the height");
  const auto scale = header.number<float>("the scale");
  if (!(std::abs(scale) > 0) || std::isinf(scale)) header.fail(fmt::format("the scale is {}", scale));
  if (image.width == 0 || image.height == 0) header.fail("the image has no pixels");

  const std::string_view pixels = bytes.substr(header.end());
  const size_t row = size_t{image.width} * image.channels;
  const size_t rows = pixels.size() / (row * sizeof(float));
  if (rows != image.height || pixels.size() % (row * sizeof(float)) != 0) {
    throw Error(ErrorCode::file, fmt::format("{}, byte {}", path, bytes.size()),
                fmt::format("{} bytes of pixels; {} x {} x {} floats were expected", pixels.size(), image.width,
                            image.height, image.channels));
  }
  image.pixels.resize(row * image.height);
  const bool swap = (scale < 0) != kLittleEndianHost;
  const float factor = std::abs(scale);
  const char* from = pixels.data();
  for (size_t y = image.height; y-- > 0;) {
    for (size_t i = 0; i < row; ++i, from += sizeof(float)) {
      image.pixels[y * row + i] = load_number<float>(from, swap) * factor;
    }
  }
  return image;
}

}  // namespace kerf
