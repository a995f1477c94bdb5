#pragma once

#include <string>

#include "kerf/io/image.h"

namespace kerf {

/// Reads a portable float map of 1 or 3 channels and either byte order; a scale other than 1 is multiplied in. Throws
/// Error (file) with the path as place where the file cannot be read, "PATH:LINE" for its three lines of text, and
/// "PATH, byte OFFSET" for bytes that are missing or left over.
Image read_pfm(const std::string& path);

}  // namespace kerf
