// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/switch_result.hpp>

#include <segue/base/diagnostic.hpp>

#include <array>

namespace segue::runtime {

namespace {

std::string why_not(Outcome outcome, const std::optional<Error>& error) {
  if (outcome == Outcome::Done) {
    return {};
  }
  if (!error) {
    return "it was " + std::string(to_string(outcome));
  }
  std::string text = to_string(*error);
  if (error->diagnostics != nullptr && error->diagnostics->items().size() > 1) {
    text += '\n' + to_string(*error->diagnostics);
    text.pop_back();  // the end of the last line
  }
  return text;
}

}  // namespace

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::Done:
      return "done";
    case Outcome::Superseded:
      return "superseded";
    case Outcome::Refused:
      return "refused";
    case Outcome::Failed:
      return "failed";
    case Outcome::Cancelled:
      return "cancelled";
  }
  return {};
}

std::string_view to_string(Cause cause) {
  static constexpr std::array<std::string_view, 7> kNames = {"request", "repair", "fallback", "look_ahead",
                                                             "tidy",    "apply",  "pool"};
  return kNames.at(static_cast<std::size_t>(cause));
}

std::string SwitchResult::why() const {
  return why_not(outcome, error);
}

std::string ApplyResult::why() const {
  return why_not(outcome, error);
}

}  // namespace segue::runtime
