#pragma once

#include <string>
#include <vector>

#include "kerf/study/inspect.h"

namespace kerf {

/// What stands out, in sentences that name figures; the most important first.
std::vector<std::string> findings(const Inspection& inspection);

/// All of it for a reader of plain text: the findings, then the figures behind them in tables and bars.
std::string inspection_text(const Inspection& inspection);

}  // namespace kerf
