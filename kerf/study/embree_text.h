#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// What Embree says of a build when it is asked to be verbose. Fields stay empty where it says nothing that is known.
struct EmbreeText {
  std::string version;    ///< "3.13.5"
  std::string builder;    ///< "avx::BVH8BuilderFastSpatialSAH"; of several kinds of primitives joined by ", "
  std::string layout;     ///< "BVH8<triangle4>"
  std::string isa;        ///< of the kernels for single rays: "avx512"
  std::string hugepages;  ///< "enabled"
  std::optional<double> references;  ///< in leaves: as percentages have two decimals, within some tenths of a percent
};

EmbreeText parse_embree_text(std::string_view text);

}  // namespace kerf
