#pragma once

#include <string>
#include <vector>

namespace kerf::test {

/// A pipeline for everything in the menu that rays can be traced through, once: each structure, each builder, each
/// optimiser and layout on binned_sah, each splitter before binned_sah, at settings that split.
std::vector<std::string> menu_pipelines();

/// The same, each word of each option besides, and what takes pieces after early splitting.
std::vector<std::string> traceable_pipelines();

/// The same, and each builder, optimiser and layout after early splitting.
std::vector<std::string> all_pipelines();

/// Letters, digits and '_' only, as GoogleTest wants names.
std::string test_name(const std::string& pipeline);

}  // namespace kerf::test
