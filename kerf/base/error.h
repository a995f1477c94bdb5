#pragma once

#include <stdexcept>
#include <string>

namespace kerf {

/// What kind of input was wrong.
enum class ErrorCode {
  invalid_geometry,  ///< a vertex that is not finite, an index out of range, a negative radius
  invalid_option,    ///< an option or a pipeline that does not exist or is out of range
  invalid_argument,  ///< spans of different lengths, a missing pointer
  not_built,         ///< a query before build()
  file,              ///< a file that cannot be read or written, or whose content is wrong
  too_large,         ///< more primitives, references or levels than a tree or its builder can hold
  stopped,           ///< a WorkLimit was reached
};

/// The one exception that Kerf throws: bad input. `place` says where ("geometry 0, vertex 17",
/// "bunny.ply:12", "structure, column 9"); what() is "place: sentence".
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string place, const std::string& sentence)
      : std::runtime_error(place.empty() ? sentence : place + ": " + sentence), code_(code), place_(std::move(place)) {}

  ErrorCode code() const noexcept { return code_; }
  const std::string& place() const noexcept { return place_; }

 private:
  ErrorCode code_;
  std::string place_;
};

}  // namespace kerf
