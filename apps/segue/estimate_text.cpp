// SPDX-License-Identifier: Apache-2.0
#include "estimate_text.hpp"

#include <segue/journal/journal_report.hpp>
#include <segue/model/files.hpp>

#include <fmt/core.h>

#include <algorithm>

#include "output.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string range_text(const model::DurationRange& range) {
  return fmt::format("{} to {}, typically {}", format_seconds(seconds(range.low)),
                     format_seconds(seconds(range.high)), format_seconds(seconds(range.typical)));
}

std::string range_text(const Value& range) {
  return fmt::format("{} to {}", format_seconds(number_at(range, "low")),
                     format_seconds(number_at(range, "high")));
}

/// The action with this id, and its position in the list.
std::size_t find_action(const model::Transition& transition, int id) {
  const auto& actions = transition.actions;
  const auto found = std::find_if(actions.begin(), actions.end(),
                                  [&](const model::Action& action) { return action.id == id; });
  return static_cast<std::size_t>(found - actions.begin());
}

std::string path_text(const solve::Estimate& estimate, const model::Transition& transition) {
  std::string text = coloured(Colour::Bold, "critical path") + '\n';
  for (const int id : estimate.critical_path) {
    const std::size_t place = find_action(transition, id);
    const model::Action& action = transition.actions.at(place);
    text += fmt::format("{:>5}  {:<8} {:>8}  {}\n", id, to_string(action.phase),
                        format_seconds(seconds(estimate.typical.at(place))), printable(action.label()));
  }
  return text;
}

bool within(const Value& range, double measured) {
  return number_at(range, "low") <= measured && measured <= number_at(range, "high");
}

}  // namespace

Value to_value(const solve::Estimate& estimate) {
  Value value = Value::map({{"total", journal::to_value(estimate.total)}});
  for (const auto phase : {model::Phase::Prepare, model::Phase::Commit, model::Phase::Retire})
    value.as_map().set(std::string(to_string(phase)), journal::to_value(estimate.of(phase)));
  Value::List path;
  for (const int id : estimate.critical_path)
    path.emplace_back(id);
  value.as_map().set("critical_path", std::move(path));
  value.as_map().set("never_measured", estimate.never_measured);
  return value;
}

std::string describe(const solve::Estimate& estimate, const model::Transition& transition) {
  if (transition.actions.empty()) return {};
  std::string text = coloured(Colour::Bold, "expected") + '\n';
  text += fmt::format("  total    {}\n", range_text(estimate.total));
  for (const auto phase : {model::Phase::Prepare, model::Phase::Commit, model::Phase::Retire}) {
    const model::DurationRange& range = estimate.of(phase);
    if (range.high > Duration(0)) text += fmt::format("  {:<8} {}\n", to_string(phase), range_text(range));
  }
  text += path_text(estimate, transition);
  const auto count = static_cast<int>(transition.actions.size());
  if (estimate.never_measured == count) {
    text += "none of these actions has been measured yet; this is a guess\n";
  } else if (estimate.never_measured > 0) {
    text += fmt::format(
        "{} of {} actions have not been measured yet and are estimated from others of their kind\n",
        estimate.never_measured, count);
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
