// SPDX-License-Identifier: Apache-2.0
#include "rest.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <vector>

#include "output.hpp"

namespace segue::cli {

using type::Value;

bool is_at_rest(const Value& rest) {
  const Value* at_rest = rest.find("at_rest");
  return at_rest != nullptr && *at_rest == Value(true);
}

std::string rest_text(const std::string& what, const Value& rest) {
  std::vector<std::string> stopped;
  for (const Value& task : list_at(rest, "stopped"))
    stopped.push_back(task.is_string() ? task.as_string() : "");
  const std::string tasks = stopped.empty() ? "" : "; stopped, since they hold devices: " + listed(stopped);
  if (!is_at_rest(rest))
    return printable(what + ", but the robot was not at rest in time: " + printable_at(rest, "trouble") +
                     tasks);
  return printable(fmt::format("{}; the robot is at rest after {}{}", what,
                               format_seconds(number_at(rest, "duration_s")), tasks));
}

}  // namespace segue::cli
