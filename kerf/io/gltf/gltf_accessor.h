#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "kerf/io/byte_order.h"
#include "kerf/io/gltf/gltf_file.h"

namespace kerf {

/// An array of numbers in a buffer, whose bytes are all there.
struct GltfAccessor {
  size_t count = 0;         ///< elements
  uint32_t components = 1;  ///< of an element, 1 to 4
  int type = 0;             ///< TINYGLTF_COMPONENT_TYPE_
  bool normalized = false;
  const char* data = nullptr;  ///< null: all are 0
  size_t stride = 0;

  size_t sparse_count = 0;  ///< elements that are replaced
  const char* sparse_indices = nullptr;
  int sparse_type = 0;
  const char* sparse_values = nullptr;
};

/// Finds accessors[number]. Fails where it is not as the rules want it, or reaches beyond its bytes; `user` says who
/// wants it. Memory that is made by its count is in proportion to the file.
GltfAccessor find_accessor(GltfFile& file, int number, std::string_view user);

/// A name such as FLOAT.
std::string_view component_name(int type);

namespace gltf_detail {

template <class T>
double as_double(const char* from, bool normalized) {
  const T value = load_number<T>(from, !kLittleEndianHost);
  if constexpr (std::is_integral_v<T> && sizeof(T) <= 2) {
    if (normalized) return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
  }
  return static_cast<double>(value);
}

/// Calls run.template operator()<T>() with the type of the components.
template <class Run>
void with_component_type(int type, Run run) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return run.template operator()<int8_t>();
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return run.template operator()<uint8_t>();
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return run.template operator()<int16_t>();
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return run.template operator()<uint16_t>();
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return run.template operator()<uint32_t>();
    default:
      return run.template operator()<float>();
  }
}

/// Index `number` of a sparse accessor; find_accessor() has checked that it is in range.
size_t sparse_index(const GltfAccessor& accessor, size_t number);

}  // namespace gltf_detail

/// Calls use(number, components) for every element, and then again for those that a sparse accessor replaces.
template <class Use>
void for_each_element(const GltfAccessor& accessor, Use use) {
  gltf_detail::with_component_type(accessor.type, [&]<class T>() {
    std::array<double, 4> element{};
    const auto load = [&](const char* from) {
      for (uint32_t i = 0; i < accessor.components; ++i) {
        element[i] = gltf_detail::as_double<T>(from + i * sizeof(T), accessor.normalized);
      }
    };
    for (size_t i = 0; i < accessor.count; ++i) {
      if (accessor.data != nullptr) load(accessor.data + i * accessor.stride);
      use(i, element);
    }
    for (size_t i = 0; i < accessor.sparse_count; ++i) {
      load(accessor.sparse_values + i * accessor.components * sizeof(T));
      use(gltf_detail::sparse_index(accessor, i), element);
    }
  });
}

}  // namespace kerf
