#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "kerf/io/material.h"
#include "kerf/io/notes.h"
#include "kerf/io/yaml/yaml_node.h"

namespace kerf {

/// The materials of a YAML scene, by name.
class YamlMaterials {
 public:
  /// Reads the section `materials`. Throws Error (file); keys that mean nothing for a type become notes.
  void read(const YamlField& section, Notes& notes);

  /// The number of the material that is named. Throws Error (file) with the nearest right name.
  uint32_t number_of(const YamlField& name) const;

  /// In the order of the file.
  const std::vector<Material>& all() const { return materials_; }

 private:
  struct Known {
    uint32_t number = 0, line = 0;
  };
  std::vector<Material> materials_;
  std::unordered_map<std::string, Known> known_;
};

}  // namespace kerf
