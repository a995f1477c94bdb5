#pragma once

#include <string>
#include <string_view>

#include "kerf/io/yaml/yaml_node.h"

namespace kerf {

/// Parses one YAML document. No document at all is a null. `name` stands for the text in errors.
///
/// Throws Error (file) with the place "NAME:LINE:COLUMN": what is no YAML, bytes that no YAML has, a second document,
/// tags, an alias within its own anchor, more than 64 levels.
YamlTree parse_yaml(std::string_view text, const std::string& name);

}  // namespace kerf
