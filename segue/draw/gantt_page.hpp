// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace segue::draw::detail {

/// gantt_page.html and its script (gantt_chart.js, gantt_page_*.js), as the build puts them into the program.
extern const std::string_view kGanttPage;
extern const std::string_view kGanttScript;

}  // namespace segue::draw::detail
