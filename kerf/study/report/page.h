#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/study/report/markup.h"

namespace kerf::report {

/// A part of the page that the contents name.
struct PageSection {
  std::string id, title;
};

/// What stands at the top of a page; empty parts are left out.
struct PageHead {
  std::string title, machine, command;
  std::vector<std::string> notes;
};

/// Everything before a page's sections: style, a policy by which nothing may be fetched, whatever a name holds, the
/// head and the contents.
void begin_page(Markup& out, const PageHead& head, std::span<const PageSection> contents);

/// Everything behind them. What begin_page() opened is closed.
void end_page(Markup& out);

/// A heading with something smaller behind it.
void write_heading(Markup& out, std::string_view tag, std::string_view text, const std::string& aside);

}  // namespace kerf::report
