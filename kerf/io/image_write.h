#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kerf/io/image.h"

namespace kerf {

// All of these write through OutputFile: the file appears whole or not at all. They throw Error (file) as that does,
// and Error (invalid_argument) for an image without pixels, with other than 1 or 3 channels, or whose count of pixels
// does not fit its size.

/// Throws the Error (invalid_argument) that is said above, with the path as place.
void check_image(const std::string& path, const Image& image);

/// Writes the floats as they are, as a little-endian portable float map.
void write_pfm(const std::string& path, const Image& image);

/// The bytes of pixels and rows that write_png() takes: stb counts them, and twice as many while it compresses, in an
/// int.
inline constexpr size_t kMostPngBytes = size_t{1} << 29;

/// The bytes of a PNG with 8 bits a channel, as write_png() writes them and with the same errors, whose place is
/// `place`. The same image gives the same bytes.
std::vector<unsigned char> encode_png(const Image& image, const std::string& place);

/// Writes 8 bits a channel. Values are meant for display, in [0, 1]; what lies outside is clamped and NaN becomes 0.
/// Throws Error (invalid_argument) for an image of more than kMostPngBytes.
void write_png(const std::string& path, const Image& image);

/// Writes the floats as they are, NaN and infinities too, as an OpenEXR file: 32 bits a channel, R, G and B or Y alone,
/// ZIP compressed. The same image gives the same bytes. Throws Error (file) in a build without OpenEXR.
void write_exr(const std::string& path, const Image& image);

enum class ImageFormat { png, pfm, exr };

/// The format that the end of a path names, in any case of letters. Throws Error (file) for one that this build cannot
/// write.
ImageFormat image_format(const std::string& path);

/// Writes in the format that the end of the path names, .png, .pfm or .exr in any case. Throws Error (file) for any
/// other.
void write_image(const std::string& path, const Image& image);

}  // namespace kerf
