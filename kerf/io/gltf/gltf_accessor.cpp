#include "kerf/io/gltf/gltf_accessor.h"

#include <fmt/format.h>

namespace kerf {
namespace {

size_t size_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

/// Whether `count` elements of `element` bytes, each `stride` after the last, lie in `bytes` from `offset` on.
bool fits(size_t count, size_t element, size_t stride, size_t offset, size_t bytes) {
  if (offset > bytes) return false;
  if (count == 0) return true;
  const size_t room = bytes - offset;
  return room >= element && (count - 1) <= (room - element) / stride;
}

void find_sparse(GltfFile& file, const tinygltf::Accessor& from, const std::string& name, size_t element,
                 GltfAccessor& accessor) {
  const auto& sparse = from.sparse;
  const auto count = static_cast<size_t>(std::max<int64_t>(sparse.count, 0));
  const auto index_offset = static_cast<size_t>(sparse.indices.byteOffset);
  const auto value_offset = static_cast<size_t>(sparse.values.byteOffset);
  const int type = sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    file.fail(fmt::format("{}.sparse.indices has the component type {}", name, component_name(type)));
  }
  const std::span<const char> indices = file.view(sparse.indices.bufferView, name + ".sparse.indices");
  const std::span<const char> values = file.view(sparse.values.bufferView, name + ".sparse.values");
  const size_t size = size_of_component(type);
  if (!fits(count, size, size, index_offset, indices.size())) {
    file.fail(fmt::format("{}.sparse.indices reaches beyond bufferViews[{}]", name, sparse.indices.bufferView));
  }
  if (!fits(count, element, element, value_offset, values.size())) {
    file.fail(fmt::format("{}.sparse.values reaches beyond bufferViews[{}]", name, sparse.values.bufferView));
  }
  accessor.sparse_count = count;
  accessor.sparse_type = type;
  accessor.sparse_indices = indices.data() + index_offset;
  accessor.sparse_values = values.data() + value_offset;
  for (size_t i = 0; i < count; ++i) {
    if (const size_t index = gltf_detail::sparse_index(accessor, i); index >= accessor.count) {
      file.fail(
          fmt::format("{}.sparse.indices has {} at {}; the accessor has {} elements", name, index, i, accessor.count));
    }
  }
}

}  // namespace

namespace gltf_detail {

size_t sparse_index(const GltfAccessor& accessor, size_t number) {
  const char* from = accessor.sparse_indices + number * size_of_component(accessor.sparse_type);
  if (accessor.sparse_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return load_number<uint8_t>(from, false);
  if (accessor.sparse_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    return load_number<uint16_t>(from, !kLittleEndianHost);
  }
  return load_number<uint32_t>(from, !kLittleEndianHost);
}

}  // namespace gltf_detail

std::string_view component_name(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return "BYTE";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return "UNSIGNED_BYTE";
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return "SHORT";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return "UNSIGNED_SHORT";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return "UNSIGNED_INT";
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return "FLOAT";
    default:
      return "(unknown)";
  }
}

GltfAccessor find_accessor(GltfFile& file, int number, std::string_view user) {
  const tinygltf::Accessor& from = file.member(file.json.accessors, number, "accessors", user);
  const std::string name = fmt::format("accessors[{}]", number);
  const size_t component = size_of_component(from.componentType);
  if (component == 0) file.fail(fmt::format("{} has the component type {}", name, from.componentType));
  GltfAccessor accessor;
  accessor.count = from.count;
  accessor.type = from.componentType;
  accessor.normalized = from.normalized;
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(from.type));
  if (components < 1 || components > 4 || from.type == TINYGLTF_TYPE_MAT2) {
    file.fail(fmt::format("{} is of matrices; {} wants vectors or single numbers", name, user));
  }
  accessor.components = static_cast<uint32_t>(components);
  const size_t element = component * accessor.components;

  if (from.bufferView >= 0) {
    const std::span<const char> view = file.view(from.bufferView, name);
    const size_t stride = file.json.bufferViews[static_cast<size_t>(from.bufferView)].byteStride;
    accessor.stride = stride == 0 ? element : stride;
    if (accessor.stride < element) {
      file.fail(fmt::format("{} has elements of {} bytes; bufferViews[{}] has a byteStride of {}", name, element,
                            from.bufferView, stride));
    }
    if (!fits(from.count, element, accessor.stride, from.byteOffset, view.size())) {
      file.fail(fmt::format("{} has {} elements of {} bytes from byte {} on; bufferViews[{}] has {} bytes", name,
                            from.count, element, from.byteOffset, from.bufferView, view.size()));
    }
    accessor.data = view.data() + from.byteOffset;
  } else if (!from.sparse.isSparse) {
    file.fail(fmt::format("{}, which {} names, has no bufferView", name, user));
  }
  if (from.sparse.isSparse) find_sparse(file, from, name, element, accessor);
  if (from.bufferView < 0 && accessor.count > file.bytes.open_bytes()) {
    file.fail(fmt::format("{} has {} elements, for which the file has too few bytes", name, from.count));
  }
  return accessor;
}

}  // namespace kerf
