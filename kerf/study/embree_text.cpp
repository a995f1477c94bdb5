#include "kerf/study/embree_text.h"

#include <cctype>
#include <cstdlib>
#include <vector>

namespace kerf {
namespace {

constexpr std::string_view kTitle = "Embree Ray Tracing Kernels ";

/// What stands between the two, or nothing; an empty `to`: up to white space.
std::string between(std::string_view line, std::string_view from, std::string_view to) {
  const size_t found = line.find(from);
  if (found == std::string_view::npos) return "";
  line.remove_prefix(found + from.size());
  const size_t end = to.empty() ? line.find_first_of(" \t") : line.find(to);
  return std::string(line.substr(0, end));
}

void append(std::string& list, const std::string& word) {
  if (!word.empty()) list += (list.empty() ? "" : ", ") + word;
}

/// The numbers before the percent signs of a line.
std::vector<double> percentages(std::string_view line) {
  std::vector<double> numbers;
  for (size_t end = line.find('%'); end != std::string_view::npos; end = line.find('%', end + 1)) {
    size_t begin = end;
    while (begin > 0 && (std::isdigit(static_cast<unsigned char>(line[begin - 1])) != 0 || line[begin - 1] == '.')) {
      --begin;
    }
    numbers.push_back(std::strtod(std::string(line.substr(begin, end - begin)).c_str(), nullptr));
  }
  return numbers;
}

/// Primitives that a leaf block of this kind holds: 4 of "BVH8<triangle4v>", else 1.
double block_size(const std::string& layout) {
  const std::string name = between(layout, "<", ">");
  const size_t digit = name.find_first_of("0123456789");
  return digit == std::string::npos ? 1 : std::strtod(name.c_str() + digit, nullptr);
}

/// Embree gives leaves, how they are spread over numbers of blocks, and how far all blocks are filled.
class LeafCount {
 public:
  void see(const std::string& line, const std::string& layout) {
    const size_t first = line.find_first_not_of(' ');
    const std::string_view text = first == std::string::npos ? "" : std::string_view(line).substr(first);
    if (text.starts_with("leaves")) {
      const std::vector<double> shares = percentages(line);
      leaves_ = std::strtod(between(line, "#nodes =", "(").c_str(), nullptr);
      filled_ = shares.empty() ? 0 : shares.back() / 100;
    } else if (text.starts_with("histogram") && leaves_ > 0) {
      const std::vector<double> shares = percentages(line);
      double blocks = 0;
      for (size_t i = 0; i < shares.size(); ++i) blocks += static_cast<double>(i + 1) * shares[i] / 100;
      count_ += leaves_ * blocks * filled_ * block_size(layout);
      leaves_ = 0;
    }
  }
  std::optional<double> count() const { return count_ > 0 ? std::optional(count_) : std::nullopt; }

 private:
  double leaves_ = 0, filled_ = 0, count_ = 0;
};

}  // namespace

EmbreeText parse_embree_text(std::string_view text) {
  EmbreeText out;
  std::string layout;
  LeafCount leaves;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line(text.substr(begin, end - begin));
    begin = end + 1;
    if (out.version.empty()) out.version = between(line, kTitle, "");
    if (out.hugepages.empty()) out.hugepages = between(line, "hugepages          = ", "");
    if (out.isa.empty()) out.isa = between(line, "intersector1  = ", "::");
    if (line.starts_with("building ")) {
      layout = between(line, "building ", " using");
      append(out.layout, layout);
      append(out.builder, between(line, " using ", ""));
    }
    leaves.see(line, layout);
  }
  out.references = leaves.count();
  return out;
}

}  // namespace kerf
