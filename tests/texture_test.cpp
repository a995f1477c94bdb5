// The decoder of textures: every kind of image that it is meant for, and what is wrong with others.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "kerf/base/error.h"
#include "kerf/io/texture_read.h"
#include "small_images.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wunknown-warning-option"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace kerf::test {
namespace {

using Bytes = std::vector<uint8_t>;

Texture decode(const std::string& text) {
  const std::vector<char> bytes(text.begin(), text.end());  // so that the address sanitizer sees a read behind it
  return decode_texture(bytes, "test.png");
}

std::string error_of(const std::string& text) {
  try {
    decode(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    return error.what();
  }
  return "no error";
}

void expect_rgb(const std::string& text, uint32_t width, uint32_t height, const Bytes& rgb) {
  const Texture texture = decode(text);
  EXPECT_EQ(texture.width, width);
  EXPECT_EQ(texture.height, height);
  EXPECT_EQ(texture.rgb, rgb);
}

// --- images ---------------------------------------------------------------------------------------------------------

std::string big(uint64_t value, int bytes) {
  std::string text = little(value, bytes);
  std::reverse(text.begin(), text.end());
  return text;
}

/// The checksum of PNG, bit by bit.
uint32_t crc(const std::string& text) {
  uint32_t value = 0xFFFFFFFFU;
  for (const char c : text) {
    value ^= static_cast<uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) value = (value & 1) != 0 ? value >> 1 ^ 0xEDB88320U : value >> 1;
  }
  return ~value;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big(data.size(), 4) + type + data + big(crc(type + data), 4);
}

/// What zlib calls a stored stream.
std::string stored(const std::string& data) {
  uint32_t a = 1, b = 0;
  for (const char c : data) {
    a = (a + static_cast<uint8_t>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return std::string("\x78\x01\x01") + little(data.size(), 2) + little(data.size() ^ 0xFFFF, 2) + data +
         big(uint64_t{b} << 16 | a, 4);
}

std::string png_head(uint32_t width, uint32_t height, int bits, int color) {
  return "\x89PNG\r\n\x1A\n" + chunk("IHDR", big(width, 4) + big(height, 4) + big(static_cast<uint64_t>(bits), 1) +
                                                 big(static_cast<uint64_t>(color), 1) + std::string(3, '\0'));
}

/// `rows` are those of the file, each with its filter in front.
std::string png(uint32_t width, uint32_t height, int bits, int color, const std::string& rows,
                const std::string& before = "") {
  return png_head(width, height, bits, color) + before + chunk("tEXt", "made by hand") + chunk("IDAT", stored(rows)) +
         chunk("IEND", "");
}

std::string bytes_of(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

const std::string kPng = png(2, 1, 8, 2, bytes_of({0, 255, 0, 1, 2, 3, 4}));
const std::string kBmp = bmp(2, 2, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}});
const std::string kTga = tga_header(2, 1, 2, 24) + bytes_of({3, 2, 1, 6, 5, 4});
const std::string kPackedTga = tga_header(3, 1, 10, 24) + bytes_of({0x81, 3, 2, 1, 0x00, 6, 5, 4});

/// A JPEG of 16 x 16 pixels, the left half red.
std::string jpeg() {
  Bytes rgb;
  for (int i = 0; i < 256; ++i) rgb.insert(rgb.end(), {static_cast<uint8_t>(i % 16 < 8 ? 200 : 10), 20, 30});
  std::string text;
  const auto write = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  EXPECT_NE(stbi_write_jpg_to_func(write, &text, 16, 16, 3, rgb.data(), 95), 0);
  return text;
}

// --- tests ----------------------------------------------------------------------------------------------------------

TEST(Texture, ReadsPngOfEveryTypeOfColour) {
  expect_rgb(kPng, 2, 1, {255, 0, 1, 2, 3, 4});
  expect_rgb(png(2, 1, 8, 6, bytes_of({0, 1, 2, 3, 0, 4, 5, 6, 9})), 2, 1, {1, 2, 3, 4, 5, 6});
  expect_rgb(png(2, 1, 8, 0, bytes_of({0, 7, 9})), 2, 1, {7, 7, 7, 9, 9, 9});
  expect_rgb(png(1, 2, 8, 4, bytes_of({0, 7, 0, 0, 9, 1})), 1, 2, {7, 7, 7, 9, 9, 9});
  expect_rgb(png(2, 1, 1, 0, bytes_of({0, 0x40})), 2, 1, {0, 0, 0, 255, 255, 255});
  expect_rgb(png(1, 1, 16, 2, bytes_of({0, 1, 99, 2, 99, 3, 99})), 1, 1, {1, 2, 3});
  expect_rgb(png(2, 1, 2, 3, bytes_of({0, 0x40}), chunk("PLTE", bytes_of({1, 2, 3, 4, 5, 6}))), 2, 1,
             {4, 5, 6, 1, 2, 3});
}

TEST(Texture, RowsBeginAtTheTop) {
  expect_rgb(kBmp, 2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  expect_rgb(png(1, 2, 8, 0, bytes_of({0, 1, 0, 2})), 1, 2, {1, 1, 1, 2, 2, 2});
  const std::string rows = bytes_of({1, 1, 1, 2, 2, 2});
  expect_rgb(tga_header(1, 2, 2, 24, 0x20) + rows, 1, 2, {1, 1, 1, 2, 2, 2});
  expect_rgb(tga_header(1, 2, 2, 24, 0) + rows, 1, 2, {2, 2, 2, 1, 1, 1});
}

TEST(Texture, ReadsTgaPackedAndNot) {
  expect_rgb(kTga, 2, 1, {1, 2, 3, 4, 5, 6});
  expect_rgb(kPackedTga, 3, 1, {1, 2, 3, 1, 2, 3, 4, 5, 6});
  expect_rgb(tga_header(2, 1, 3, 8) + bytes_of({7, 9}), 2, 1, {7, 7, 7, 9, 9, 9});
  expect_rgb(tga_header(1, 1, 2, 32) + bytes_of({3, 2, 1, 0}), 1, 1, {1, 2, 3});
}

TEST(Texture, ReadsJpegNearly) {
  const Texture texture = decode(jpeg());
  ASSERT_EQ(texture.width, 16U);
  ASSERT_EQ(texture.rgb.size(), 768U);
  EXPECT_NEAR(texture.rgb[0], 200, 6);
  EXPECT_NEAR(texture.rgb[1], 20, 6);
  EXPECT_NEAR(texture.rgb[15 * 3], 10, 6);
}

TEST(Texture, EveryCutIsAnError) {
  for (const std::string& image : {kPng, kBmp, kTga, kPackedTga, jpeg()}) {
    EXPECT_EQ(error_of(image), "no error");
    EXPECT_EQ(error_of(image + "what follows"), "no error");
    for (size_t size = 0; size < image.size(); ++size) {
      EXPECT_NE(error_of(image.substr(0, size)), "no error") << image.substr(0, 3) << size;
    }
  }
}

TEST(Texture, DamageDoesNoHarm) {
  for (const std::string& image : {kPng, kBmp, kTga, kPackedTga, jpeg()}) {
    for (size_t at = 0; at < image.size(); ++at) {
      for (const int byte : {0, 1, 2, 0x7F, 0x80, 0xD9, 0xFE, 0xFF}) {
        std::string damaged = image;
        damaged[at] = static_cast<char>(byte);
        try {
          const Texture texture = decode(damaged);
          EXPECT_EQ(texture.rgb.size(), size_t{texture.width} * texture.height * 3);
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::file);
        }
      }
    }
  }
}

TEST(Texture, DamagedPartsOfAPngAreErrors) {
  // All but the comment, which nothing depends on.
  const size_t comment = kPng.find("tEXt") - 4, pixels = kPng.find("IDAT") - 4;
  for (size_t at = 0; at < kPng.size(); ++at) {
    if (at >= comment && at < pixels) continue;
    std::string damaged = kPng;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_NE(error_of(damaged), "no error") << at;
  }
  std::string damaged = kPng;
  damaged[kPng.find("IDAT") + 12] ^= 1;
  EXPECT_EQ(error_of(damaged), "test.png: is damaged: the checksum of its part IDAT is wrong");
}

TEST(Texture, SizesThatTheBytesCannotHoldAreRefusedBeforeMemoryIsTaken) {
  const std::string few = "test.png: has fewer bytes than so many pixels can be packed into";
  EXPECT_EQ(error_of(png(16000, 16000, 8, 2, bytes_of({0, 1, 2, 3}))), few);
  EXPECT_EQ(error_of(png(0xFFFFFFFF, 0xFFFFFFFF, 16, 6, "")), few);
  EXPECT_EQ(error_of(tga_header(60000, 60000, 2, 24) + "abc"), "test.png: is cut short");
  EXPECT_EQ(error_of(tga_header(60000, 60000, 10, 24) + "abc"), "test.png: is cut short");
  EXPECT_EQ(error_of(kBmp.substr(0, 18) + little(1U << 30, 4) + little(1U << 30, 4) + kBmp.substr(26)),
            "test.png: is cut short");
  std::string large = jpeg();
  const size_t frame = large.find("\xFF\xC0");
  large.replace(frame + 5, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(error_of(large), few);
}

/// The image without the segments of this marker.
std::string without_segments(std::string image, char marker) {
  for (size_t at = 2; image[at + 1] != '\xDA';) {
    const size_t size = 2 + (static_cast<uint8_t>(image[at + 2]) << 8 | static_cast<uint8_t>(image[at + 3]));
    if (image[at + 1] == marker) {
      image.erase(at, size);
    } else {
      at += size;
    }
  }
  return image;
}

TEST(Texture, JpegsOfWhichTheDecoderWouldReadWhatIsNotThereAreRefused) {
  const std::string image = jpeg(), damaged = "test.png: is damaged: ";
  EXPECT_EQ(error_of(without_segments(image, '\xDB')), damaged + "a table is missing");
  EXPECT_EQ(error_of(without_segments(image, '\xC4')), damaged + "a table is missing");
  EXPECT_EQ(error_of(without_segments(image, '\xC0')), damaged + "a scan is of a colour that the image has not");
  // 257 codes, in a segment that is long enough for them.
  const std::string codes = bytes_of({0x11}) + std::string(15, '\x10') + bytes_of({17}) + std::string(257, 'x');
  std::string many = without_segments(image, '\xC4');
  many.insert(2, "\xFF\xC4" + big(codes.size() + 2, 2) + codes);
  EXPECT_EQ(error_of(many), damaged + "a Huffman table is none");
  // A scan of but the first of three colours: its header has two bytes for each.
  std::string grey = image;
  const size_t scan = grey.find("\xFF\xDA");
  grey.replace(scan + 2, 9, bytes_of({0, 8, 1}) + grey.substr(scan + 5, 2));
  EXPECT_EQ(error_of(grey), damaged + "a colour has no pixels");
  // What follows a progressive frame is a refinement of nothing.
  std::string refined = image;
  refined[refined.find("\xFF\xC0") + 1] = '\xC2';
  refined[refined.find("\xFF\xDA") + 13] = '\x10';
  EXPECT_EQ(error_of(refined), damaged + "a scan refines a colour that has no pixels yet");
}

TEST(Texture, MoreThanTwoToThe28PixelsAreRefused) {
  const std::string large =
      png_head(1U << 15, (1U << 13) + 1, 1, 0) + chunk("IDAT", std::string(40000, '\0')) + chunk("IEND", "");
  EXPECT_EQ(error_of(large), "test.png: has 32768 x 8193 pixels; at most 2^28 are read");
}

TEST(Texture, WhatTheDecoderWouldGetWrongIsRefused) {
  EXPECT_EQ(error_of(tga_header(2, 1, 2, 24, 0x30) + bytes_of({3, 2, 1, 6, 5, 4})),
            "test.png: has its pixels from right to left, which is not read");
  std::string palette = kTga;
  palette.replace(1, 7, bytes_of({1, 2, 0, 0, 1, 0, 24}));
  EXPECT_EQ(error_of(palette + "abc"), "test.png: has a palette without use");
  // A BMP of 8 bits with two colours, and a pixel of the third.
  const auto indexed = [](int index) {
    return "BM" + little(66, 4) + little(0, 4) + little(62, 4) + little(40, 4) + little(1, 4) + little(1, 4) +
           little(1, 2) + little(8, 2) + little(0, 16) + little(2, 4) + little(2, 4) +
           bytes_of({1, 2, 3, 0, 4, 5, 6, 0, index, 0, 0, 0});
  };
  expect_rgb(indexed(1), 1, 1, {6, 5, 4});
  EXPECT_EQ(error_of(indexed(2)), "test.png: is damaged: it has pixels beyond its palette of 2 colours");
}

TEST(Texture, WhatIsNoImageIsAnError) {
  EXPECT_EQ(error_of(""), "test.png: is not an image: the file is empty");
  for (const std::string& text : {std::string("GIF89a"), std::string("hello"), std::string(1000, '\0'),
                                  std::string(1000, '\xFF'), std::string(1000, 'x')}) {
    EXPECT_EQ(error_of(text), "test.png: is not a PNG, JPEG, TGA or BMP image");
  }
}

TEST(Texture, IsRecognizedByItsFirstBytesOrItsName) {
  EXPECT_TRUE(is_texture(kPng, "a.dds"));
  EXPECT_TRUE(is_texture(jpeg(), "a"));
  EXPECT_TRUE(is_texture(kBmp, "a"));
  EXPECT_TRUE(is_texture(kTga, "folder.x/a.TGA"));
  EXPECT_TRUE(is_texture(std::string("damaged"), "a.JPeG"));
  EXPECT_FALSE(is_texture(std::string("DDS |"), "a.dds"));
}

TEST(Texture, FilesAreReadWithTheirPathInErrors) {
  const std::string path = testing::TempDir() + "kerf_texture_test." + std::to_string(::getpid()) + ".bmp";
  std::ofstream(path, std::ios::binary) << kBmp;
  EXPECT_EQ(read_texture(path).rgb.size(), 12U);
  std::ofstream(path, std::ios::binary) << kBmp.substr(0, 60);
  try {
    read_texture(path);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), path + ": is cut short");
  }
  std::filesystem::remove(path);
  EXPECT_THROW(read_texture(path), Error);
}

}  // namespace
}  // namespace kerf::test
