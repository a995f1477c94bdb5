#include <fmt/format.h>

#include <limits>
#include <new>
#include <string>
#include <string_view>

#include "kerf/base/error.h"
#include "kerf/io/image_write.h"
#include "kerf/io/output_file.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#pragma GCC diagnostic pop

namespace kerf {
namespace {

/// The file is made in memory, as OpenEXR goes back in it when all else is written, to say where the lines stand.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}

  void write(const char bytes[], int count) override {
    const auto length = static_cast<size_t>(count);
    if (position_ + length > content_.size()) content_.resize(position_ + length);
    content_.replace(position_, length, bytes, length);
    position_ += length;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }

  std::string_view content() const { return content_; }

 private:
  std::string content_;
  size_t position_ = 0;
};

void encode(const Image& image, MemoryStream& stream) {
  const std::string_view names = image.channels == 3 ? "RGB" : "Y";
  Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer pixels;
  const size_t pixel = image.channels * sizeof(float);
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string name(1, names[i]);
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    // OpenEXR asks for a pointer to what it may change, but only reads.
    char* first = reinterpret_cast<char*>(const_cast<float*>(image.pixels.data() + i));
    pixels.insert(name, Imf::Slice(Imf::FLOAT, first, pixel, pixel * image.width));
  }
  Imf::OutputFile file(stream, header, 0);  // no threads of its own
  file.setFrameBuffer(pixels);
  file.writePixels(static_cast<int>(image.height));
}

}  // namespace

void write_exr(const std::string& path, const Image& image) {
  check_image(path, image);
  constexpr uint32_t kLimit = std::numeric_limits<int32_t>::max();
  if (image.width > kLimit || image.height > kLimit) {
    throw Error(ErrorCode::invalid_argument, path,
                fmt::format("{} x {} pixels are too many for an EXR; write a PFM", image.width, image.height));
  }
  MemoryStream stream(path);
  try {
    encode(image, stream);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::file, path, fmt::format("could not be made as an EXR: {}", error.what()));
  }
  OutputFile file(path);
  file.write(stream.content());
  file.commit();
}

}  // namespace kerf
