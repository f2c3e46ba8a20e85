// SPDX-License-Identifier: Apache-2.0
#include "estimate_text.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <string_view>

#include "output.hpp"
#include "report_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string range_text(const Value& range) {
  return fmt::format("{} to {}", format_seconds(number_at(range, "low")),
                     format_seconds(number_at(range, "high")));
}

std::string typical_range_text(const Value& range) {
  return fmt::format("{}, typically {}", range_text(range), format_seconds(number_at(range, "typical")));
}

std::string path_text(const Value& estimate, const Value::List& actions) {
  std::string text = coloured(Colour::Bold, "critical path") + '\n';
  const auto& typical = list_at(estimate, "actions");
  for (const Value& id : list_at(estimate, "critical_path")) {
    const std::size_t place = id.is_number() ? static_cast<std::size_t>(id.as_double()) - 1 : actions.size();
    if (place >= actions.size() || place >= typical.size() || !typical[place].is_number()) continue;
    const Value& action = actions[place];
    text += fmt::format("{:>5}  {:<8} {:>8}  {}\n", number_at(action, "id"), printable_at(action, "phase"),
                        format_seconds(typical[place].as_double()), action_label(action));
  }
  return text;
}

bool within(const Value& range, double measured) {
  return number_at(range, "low") <= measured && measured <= number_at(range, "high");
}

}  // namespace

std::string estimate_text(const Value& transition) {
  const Value* estimate = transition.find("estimate_s");
  const auto& actions = list_at(transition, "actions");
  if (estimate == nullptr || actions.empty()) return {};
  std::string text = coloured(Colour::Bold, "expected") + '\n';
  for (const std::string_view part : {"total", "prepare", "commit", "retire"}) {
    const Value* range = estimate->find(part);
    if (range != nullptr && (part == "total" || number_at(*range, "high") > 0))
      text += fmt::format("  {:<8} {}\n", part, typical_range_text(*range));
  }
  text += path_text(*estimate, actions);
  const auto count = actions.size();
  const auto unmeasured = static_cast<std::size_t>(number_at(*estimate, "never_measured"));
  if (unmeasured == count) {
    text += "none of these actions has been measured yet; this is a guess\n";
  } else if (unmeasured > 0) {
    text += fmt::format(
        "{} of {} actions have not been measured yet and are estimated from others of their kind\n",
        unmeasured, count);
  }
  return text;
}

std::string expectation_of(const Value& result) {
  const Value* predicted = result.find("predicted_s");
  if (predicted == nullptr) return {};
  const Value* total = predicted->find("total");
  const Value* commit = predicted->find("commit");
  if (total == nullptr || commit == nullptr) return {};
  return fmt::format("; expected {} (commit {})", range_text(*total), range_text(*commit));
}

void Forecasts::add(const Value& result) {
  const Value* predicted = result.find("predicted_s");
  if (predicted == nullptr || printable_at(result, "outcome") != "done") return;
  const Value* total = predicted->find("total");
  const Value* commit = predicted->find("commit");
  if (total == nullptr || commit == nullptr) return;
  ++count_;
  total_right_ += within(*total, number_at(result, "duration_s")) ? 1 : 0;
  commit_right_ += within(*commit, number_at(result, "commit_s")) ? 1 : 0;
}

std::string Forecasts::verdict() const {
  if (count_ == 0) return {};
  return fmt::format("as expected: {} of {} in total, {} of {} in commit", total_right_, count_,
                     commit_right_, count_);
}

}  // namespace segue::cli
