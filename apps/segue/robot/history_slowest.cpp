// SPDX-License-Identifier: Apache-2.0
#include "history_slowest.hpp"

#include <segue/base/rounded_text.hpp>

#include <algorithm>
#include <functional>
#include <map>

#include "../output.hpp"

namespace segue::cli {

namespace {

using model::ActionKind;
using model::Phase;

/// Control is interrupted for longer than a period of a fast controller.
constexpr double kSlowCommit = 0.01;
/// Somebody who waits for a switch notices it.
constexpr double kSlowOutside = 0.1;

std::string hint_in_commit(ActionKind kind) {
  switch (kind) {
    case ActionKind::Start:
      return "interrupts control: move work from on_start to on_configure";
    case ActionKind::Stop:
      return "interrupts control: move work from on_stop to on_cleanup, and shorten updates and operations";
    case ActionKind::Configure:
    case ActionKind::Cleanup:
      return "interrupts control: properties that change here could be live, or the device be released in "
             "on_stop";
    case ActionKind::ApplyConfig:
      return "interrupts control: it waits for the end of the task's update";
    case ActionKind::HandOver:
      return "interrupts control: hand over less state";
    default:
      return "interrupts control";
  }
}

std::string hint_outside(ActionKind kind) {
  switch (kind) {
    case ActionKind::Configure:
    case ActionKind::Deploy:
      return "`segue prepare`, or a mission's look-ahead, does it before the switch";
    case ActionKind::Cleanup:
    case ActionKind::Undeploy:
      return "control goes on meanwhile, but the next switch waits for it";
    default:
      return {};
  }
}

}  // namespace

std::vector<SlowAction> slowest_actions(const std::vector<journal::TransitionEntry>& transitions,
                                        std::size_t limit) {
  std::map<std::string, SlowAction> by_label;
  for (const journal::TransitionEntry& transition : transitions) {
    for (const journal::ActionEntry& action : transition.actions) {
      if (action.outcome != journal::kDone) continue;
      const double seconds = std::chrono::duration<double>(action.duration).count();
      SlowAction& slow = by_label[action.label];
      slow.label = action.label;
      slow.component = action.component;
      slow.kind = action.kind;
      slow.phase = action.phase;
      ++slow.count;
      slow.sum += seconds;
      slow.most = std::max(slow.most, seconds);
    }
  }
  std::vector<SlowAction> slowest;
  for (auto& [label, action] : by_label)
    slowest.push_back(std::move(action));
  std::ranges::stable_sort(slowest, std::ranges::greater{}, &SlowAction::mean);
  slowest.resize(std::min(slowest.size(), limit));
  return slowest;
}

std::string hint_about(const SlowAction& action) {
  if (action.phase == Phase::Commit) return action.mean() < kSlowCommit ? "" : hint_in_commit(action.kind);
  return action.mean() < kSlowOutside ? "" : hint_outside(action.kind);
}

std::string slowest_text(const std::vector<SlowAction>& actions) {
  constexpr auto kRight = Table::Align::Right;
  Table table({{"action"},
               {"component"},
               {"phase"},
               {"count", kRight},
               {"mean", kRight},
               {"most", kRight},
               {"hint"}});
  for (const SlowAction& action : actions) {
    table.add({printable(action.label), printable(action.component), std::string(to_string(action.phase)),
               std::to_string(action.count), format_seconds(action.mean()), format_seconds(action.most),
               hint_about(action)});
  }
  return table.text();
}

type::Value::List slowest_value(const std::vector<SlowAction>& actions) {
  type::Value::List list;
  for (const SlowAction& action : actions) {
    list.push_back(type::Value::map({{"action", action.label},
                                     {"kind", to_string(action.kind)},
                                     {"component", action.component},
                                     {"phase", to_string(action.phase)},
                                     {"count", std::uint64_t{action.count}},
                                     {"mean_s", action.mean()},
                                     {"most_s", action.most},
                                     {"hint", hint_about(action)}}));
  }
  return list;
}

}  // namespace segue::cli
