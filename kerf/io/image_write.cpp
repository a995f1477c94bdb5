#include "kerf/io/image_write.h"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <string_view>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/message.h"
#include "kerf/io/output_file.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wunknown-warning-option"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC  // other libraries bring a copy of their own
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace kerf {

void check_image(const std::string& path, const Image& image) {
  const auto refuse = [&](const std::string& sentence) { throw Error(ErrorCode::invalid_argument, path, sentence); };
  if (image.channels != 1 && image.channels != 3) {
    refuse(fmt::format("the image has {} channels; 1 or 3 can be written", image.channels));
  }
  if (image.width == 0 || image.height == 0) {
    refuse(fmt::format("the image has no pixels ({} x {})", image.width, image.height));
  }
  // Divided, as the product of three such numbers may overflow.
  const size_t row = size_t{image.width} * image.channels;
  if (image.pixels.size() % row != 0 || image.pixels.size() / row != image.height) {
    refuse(fmt::format("the image has {} values; {} x {} x {} were expected", image.pixels.size(), image.width,
                       image.height, image.channels));
  }
}

namespace {

unsigned char to_byte(float value) {
  if (!(value > 0)) return 0;  // NaN too
  if (value >= 1) return 255;
  return static_cast<unsigned char>(value * 255 + 0.5F);
}

bool has_extension(std::string_view path, std::string_view extension) {
  return path.size() >= extension.size() &&
         equals_ignoring_case(path.substr(path.size() - extension.size()), extension);
}

}  // namespace

void write_pfm(const std::string& path, const Image& image) {
  check_image(path, image);
  OutputFile file(path);
  file.write(fmt::format("{}\n{} {}\n-1.0\n", image.channels == 3 ? "PF" : "Pf", image.width, image.height));
  const size_t row = size_t{image.width} * image.channels;
  std::vector<float> turned(row);
  for (size_t y = image.height; y-- > 0;) {  // the format begins at the bottom
    const auto* values = reinterpret_cast<const char*>(image.pixels.data() + y * row);
    for (size_t i = 0; i < row; ++i) turned[i] = load_number<float>(values + i * sizeof(float), !kLittleEndianHost);
    file.write({reinterpret_cast<const char*>(turned.data()), row * sizeof(float)});
  }
  file.commit();
}

std::vector<unsigned char> encode_png(const Image& image, const std::string& place) {
  check_image(place, image);
  const size_t row = size_t{image.width} * image.channels;
  if (image.pixels.size() + image.height > kMostPngBytes) {
    throw Error(ErrorCode::invalid_argument, place,
                fmt::format("{} x {} pixels are too many for a PNG; write a PFM", image.width, image.height));
  }
  std::vector<unsigned char> bytes;
  bytes.reserve(image.pixels.size());
  for (const float value : image.pixels) bytes.push_back(to_byte(value));
  int size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> png(
      stbi_write_png_to_mem(bytes.data(), static_cast<int>(row), static_cast<int>(image.width),
                            static_cast<int>(image.height), static_cast<int>(image.channels), &size),
      std::free);
  if (png == nullptr) throw std::bad_alloc();
  return {png.get(), png.get() + size};
}

void write_png(const std::string& path, const Image& image) {
  const std::vector<unsigned char> png = encode_png(image, path);
  OutputFile file(path);
  file.write({reinterpret_cast<const char*>(png.data()), png.size()});
  file.commit();
}

#ifndef KERF_HAVE_OPENEXR
void write_exr(const std::string& path, const Image&) {
  throw Error(ErrorCode::file, path,
              "this build cannot write EXR, as OpenEXR was not there; .png and .pfm can be written");
}
#endif

void write_image(const std::string& path, const Image& image) {
  switch (image_format(path)) {
    case ImageFormat::png:
      return write_png(path, image);
    case ImageFormat::pfm:
      return write_pfm(path, image);
    case ImageFormat::exr:
      return write_exr(path, image);
  }
}

ImageFormat image_format(const std::string& path) {
  if (has_extension(path, ".png")) return ImageFormat::png;
  if (has_extension(path, ".pfm")) return ImageFormat::pfm;
#ifdef KERF_HAVE_OPENEXR
  if (has_extension(path, ".exr")) return ImageFormat::exr;
  throw Error(ErrorCode::file, path, "has an unknown image format; .png, .pfm and .exr can be written");
#else
  if (has_extension(path, ".exr")) write_exr(path, {});
  throw Error(ErrorCode::file, path, "has an unknown image format; .png and .pfm can be written");
#endif
}

}  // namespace kerf
