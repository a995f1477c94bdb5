#pragma once

#include <string>
#include <vector>

namespace kerf::test {

/// A pipeline for everything in the menu that rays can be traced through: each structure, each builder, each layout on
/// binned_sah, each splitter before binned_sah and before what takes its pieces, at settings that split. Structures,
/// builders and layouts once more for each word of their options.
std::vector<std::string> traceable_pipelines();

/// The same, and each builder and layout after early splitting.
std::vector<std::string> all_pipelines();

/// Letters, digits and '_' only, as GoogleTest wants names.
std::string test_name(const std::string& pipeline);

}  // namespace kerf::test
