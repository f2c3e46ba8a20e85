// SPDX-License-Identifier: Apache-2.0
#include "health_text.hpp"

#include <segue/base/printable.hpp>

#include <fmt/core.h>

#include "../output.hpp"

namespace segue::cli {

using type::Value;

std::string health_state(const Value& status) {
  const Value* health = status.find("health");
  return health == nullptr ? std::string() : printable_at(*health, "state");
}

/// The state of the runtime, or of the robot where something is wrong with it: a robot with broken parts is
/// not "idle".
std::string state_text(const Value& status) {
  const std::string health = health_state(status);
  if (health == "lost") return coloured(Colour::Red, "lost");
  return health == "in_trouble" ? coloured(Colour::Red, "in trouble") : printable_at(status, "state");
}

/// The robot's troubles: each with its time, its reason and its repair.
std::string troubles_text(const Value& status) {
  const Value* health = status.find("health");
  std::string text;
  if (health == nullptr || health_state(status) == "lost") return text;
  for (const Value& trouble : list_at(*health, "troubles")) {
    const std::string why = printable_at(trouble, "why");
    text += fmt::format("{}{}, since {}{}\n  repair: {}\n", coloured(Colour::Red, "trouble: "),
                        printable_at(trouble, "what"), format_seconds(number_at(trouble, "for_s")),
                        why.empty() ? "" : ": " + printable(why), printable_at(trouble, "repair"));
  }
  return text;
}

}  // namespace segue::cli
