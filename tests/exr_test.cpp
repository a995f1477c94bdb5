// EXR pictures, read back with OpenEXR.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "kerf/io/image_write.h"
#include "support/error_of.h"
#include "support/folder.h"
#include "support/random.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#pragma GCC diagnostic pop

namespace kerf::test {
namespace {

/// Bits of any kind: NaNs with what they carry, infinities, denormals and minus zero among them.
Image noise(uint32_t width, uint32_t height, uint32_t channels) {
  Image image{width, height, channels, {}};
  Random random(width * 7919 + height);
  for (size_t i = 0; i < size_t{width} * height * channels; ++i) {
    image.pixels.push_back(std::bit_cast<float>(static_cast<uint32_t>(random.bits())));
  }
  const float special[] = {NAN, -NAN, INFINITY, -INFINITY, -0.F, std::numeric_limits<float>::denorm_min()};
  for (size_t i = 0; i < std::min(std::size(special), image.pixels.size()); ++i) image.pixels[i] = special[i];
  return image;
}

/// The floats of a file, as Image has them; its channels must be these and no others.
std::vector<float> read_back(const std::string& path, const std::string& channels, uint32_t width, uint32_t height) {
  Imf::InputFile file(path.c_str(), 0);
  const Imath::Box2i window = file.header().dataWindow();
  EXPECT_EQ(window.min, Imath::V2i(0, 0));
  EXPECT_EQ(window.max, Imath::V2i(static_cast<int>(width) - 1, static_cast<int>(height) - 1));
  EXPECT_EQ(file.header().displayWindow(), window);
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  std::string found;
  for (auto i = file.header().channels().begin(); i != file.header().channels().end(); ++i) {
    found += i.name();
    EXPECT_EQ(i.channel().type, Imf::FLOAT);
  }
  EXPECT_EQ(found, channels == "RGB" ? "BGR" : channels);  // in the order of the alphabet
  std::vector<float> values(size_t{width} * height * channels.size());
  Imf::FrameBuffer pixels;
  const size_t pixel = channels.size() * sizeof(float);
  for (size_t i = 0; i < channels.size(); ++i) {
    pixels.insert(channels.substr(i, 1),
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data() + i), pixel, pixel * width));
  }
  file.setFrameBuffer(pixels);
  file.readPixels(0, static_cast<int>(height) - 1);
  return values;
}

TEST(Exr, EveryBitComesBack) {
  const Folder folder;
  for (const uint32_t channels : {1U, 3U}) {
    for (const auto& [width, height] : {std::pair{1U, 1U}, {7U, 5U}, {3U, 40U}, {200U, 33U}}) {
      const Image image = noise(width, height, channels);
      write_image(folder.path("image.EXR"), image);
      const std::vector<float> values = read_back(folder.path("image.EXR"), channels == 3 ? "RGB" : "Y", width, height);
      ASSERT_EQ(values.size(), image.pixels.size());
      for (size_t i = 0; i < values.size(); ++i) {
        ASSERT_EQ(std::bit_cast<uint32_t>(values[i]), std::bit_cast<uint32_t>(image.pixels[i])) << i;
      }
    }
  }
}

TEST(Exr, TheSameImageGivesTheSameBytes) {
  const Folder folder;
  const Image image = noise(300, 200, 3);
  write_exr(folder.path("first.exr"), image);
  write_exr(folder.path("second.exr"), image);
  EXPECT_EQ(content_of(folder.path("first.exr")), content_of(folder.path("second.exr")));
  EXPECT_GT(content_of(folder.path("first.exr")).size(), 300U * 200 * 3);
}

TEST(Exr, AFlatImageIsCompressed) {
  const Folder folder;
  write_exr(folder.path("flat.exr"), {256, 256, 3, std::vector<float>(size_t{256} * 256 * 3, 0.5F)});
  EXPECT_LT(content_of(folder.path("flat.exr")).size(), 10000U);
}

TEST(Exr, WhatCannotBeWrittenLeavesNoFile) {
  const Folder folder;
  const std::string path = folder.path("a.exr");
  const auto refused = [&](const Image& image) {
    return error_of(ErrorCode::invalid_argument, [&] { write_exr(path, image); });
  };
  EXPECT_EQ(refused({1, 1, 2, {0, 0}}), path + ": the image has 2 channels; 1 or 3 can be written");
  EXPECT_EQ(refused({0, 1, 1, {}}), path + ": the image has no pixels (0 x 1)");
  EXPECT_EQ(refused({2, 1, 1, {0}}), path + ": the image has 1 values; 2 x 1 x 1 were expected");
  const std::string nowhere = folder.path("no/a.exr");
  const std::string what = error_of(ErrorCode::file, [&] { write_exr(nowhere, {1, 1, 1, {0}}); });
  EXPECT_TRUE(what.starts_with(nowhere + ": ")) << what;
  EXPECT_EQ(folder.count(), 0U);
}

TEST(Exr, IsAFormatThatANameMayEndWith) {
  EXPECT_EQ(image_format("a.exr"), ImageFormat::exr);
  EXPECT_EQ(image_format("a.b.ExR"), ImageFormat::exr);
  EXPECT_EQ(image_format("a.png"), ImageFormat::png);
  EXPECT_EQ(image_format("a.PFM"), ImageFormat::pfm);
  EXPECT_EQ(error_of(ErrorCode::file, [] { image_format("a.ex"); }),
            "a.ex: has an unknown image format; .png, .pfm and .exr can be written");
}

}  // namespace
}  // namespace kerf::test
