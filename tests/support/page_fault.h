#pragma once

#include <regex>
#include <string>
#include <vector>

namespace kerf::test {

inline size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The first place where the page is not well-formed XML: a tag that is not closed in order, a bare sign. Empty: none.
inline std::string fault_of(const std::string& page) {
  static const std::regex tag_form("^</?([a-z][a-z0-9]*)((?: [a-zA-Z-]+=\"[^\"<]*\")*)(/?)>");
  static const std::regex entity_form("^&(?:amp|lt|gt|quot|#39);");
  std::vector<std::string> open;
  const std::string begin = "<!DOCTYPE html>\n";
  if (page.rfind(begin, 0) != 0) return "no document type";
  for (size_t i = begin.size(); i < page.size();) {
    const std::string near = page.substr(i, 60);
    const auto from = page.begin() + static_cast<std::ptrdiff_t>(i);
    std::smatch match;
    if (page[i] == '<') {
      // Tags hold pictures as large as they like; a regular expression that long would not return.
      const size_t end = page.find('>', i);
      std::string tag = page.substr(i, end - i + 1);
      if (const size_t data = tag.find("base64,"); data != std::string::npos)
        tag.erase(data, tag.find('"', data) - data);
      if (!std::regex_match(tag, match, tag_form)) return "no tag: " + near;
      if (tag[1] == '/') {
        if (open.empty() || open.back() != match[1]) return "closed out of order: " + near;
        open.pop_back();
      } else if (match[3].length() == 0) {
        open.push_back(match[1]);
      }
      i = end + 1;
    } else if (page[i] == '&') {
      if (!std::regex_search(from, page.end(), match, entity_form, std::regex_constants::match_continuous)) {
        return "bare &: " + near;
      }
      i += static_cast<size_t>(match.length());
    } else {
      if (open.empty() && page[i] != '\n') return "text outside: " + near;
      ++i;
    }
  }
  return open.empty() ? "" : "not closed: " + open.back();
}

}  // namespace kerf::test
