#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// Walks over the segments of a JPEG without decoding it and says what is wrong with it, as texture_fault() does: it is
/// cut short, its tables are damaged or missing, a colour has no pixels. The decoder believes all that.
std::string jpeg_fault(std::string_view bytes);

}  // namespace kerf
