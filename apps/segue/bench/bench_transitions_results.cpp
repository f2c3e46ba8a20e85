// SPDX-License-Identifier: Apache-2.0
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/draw/chart.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "../output.hpp"
#include "bench_transitions.hpp"

namespace segue::cli {

namespace {

constexpr std::size_t kSlowestActions = 3;

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values)
    sum += value;
  return sum / static_cast<double>(values.size());
}

/// nullptr: it was not executed.
const MeasuredTransition* find(const TransitionsReport& report, const std::string& from,
                               const std::string& to) {
  const auto found = report.transitions.find({from, to});
  return found == report.transitions.end() || found->second.seconds.empty() ? nullptr : &found->second;
}

std::optional<double> published(const TransitionsReport& report, std::size_t from, std::size_t to) {
  if (report.published.empty()) return std::nullopt;
  const std::size_t row = from * (report.controllers.size() - 1);
  return report.published.at(row + to - (to > from ? 1 : 0));
}

std::string matrix_text(const TransitionsReport& report) {
  std::vector<Table::Column> columns = {{"from \\ to"}};
  for (const std::string& to : report.controllers)
    columns.push_back({to, Table::Align::Right});
  Table table(std::move(columns));
  for (std::size_t from = 0; from < report.controllers.size(); ++from) {
    std::vector<std::string> row = {report.controllers[from]};
    for (std::size_t to = 0; to < report.controllers.size(); ++to) {
      const auto* measured = find(report, report.controllers[from], report.controllers[to]);
      row.push_back(measured == nullptr ? "-" : format_seconds(mean_of(measured->seconds)));
      if (const auto other = from == to ? std::nullopt : published(report, from, to))
        row.back() += fmt::format(" ({:.2f} s)", *other);
    }
    table.add(std::move(row));
  }
  return table.text();
}

using MeanOfAction = std::pair<std::string, double>;

/// Those whose mean is largest, slowest first.
std::vector<MeanOfAction> slowest_of(const MeasuredTransition& transition) {
  std::vector<MeanOfAction> slowest;
  for (const auto& [label, seconds] : transition.actions)
    slowest.emplace_back(label, mean_of(seconds));
  std::ranges::stable_sort(slowest, std::ranges::greater{}, &MeanOfAction::second);
  slowest.resize(std::min(slowest.size(), kSlowestActions));
  return slowest;
}

std::string slowest_text(const MeasuredTransition& transition) {
  std::vector<std::string> texts;
  for (const auto& [label, seconds] : slowest_of(transition))
    texts.push_back(label + ' ' + format_seconds(seconds));
  return listed(texts);
}

/// Calls `use` for each transition that was executed, in the order of the matrix.
template <class Use>
void for_each_transition(const TransitionsReport& report, Use use) {
  for (const std::string& from : report.controllers) {
    for (const std::string& to : report.controllers) {
      if (const auto* measured = find(report, from, to)) use(from, to, *measured);
    }
  }
}

std::string actions_text(const TransitionsReport& report) {
  using enum model::ActionKind;
  constexpr auto kRight = Table::Align::Right;
  Table table({{"transition"},
               {"count", kRight},
               {"median", kRight},
               {"commit", kRight},
               {"actions", kRight},
               {"undeploy", kRight},
               {"disconnect", kRight},
               {"deploy", kRight},
               {"apply config", kRight},
               {"connect", kRight},
               {"state changes", kRight},
               {"slowest actions"}});
  for_each_transition(report, [&](const std::string& from, const std::string& to,
                                  const MeasuredTransition& one) {
    std::vector<std::string> row = {
        from + " -> " + to, std::to_string(one.seconds.size()), format_seconds(draw::median_of(one.seconds)),
        format_seconds(draw::median_of(one.commit)), std::to_string(one.counts.total())};
    for (const model::ActionKind kind : {Undeploy, Disconnect, Deploy, ApplyConfig, Connect})
      row.push_back(std::to_string(one.counts.of(kind)));
    row.push_back(std::to_string(one.counts.state_changes()));
    row.push_back(slowest_text(one));
    table.add(std::move(row));
  });
  return table.text();
}

}  // namespace

void add_switch(MeasuredTransition& transition, const runtime::SwitchResult& result, double seconds) {
  transition.seconds.push_back(seconds);
  transition.commit.push_back(std::chrono::duration<double>(result.commit).count());
  model::Transition executed;
  for (const runtime::ActionRecord& record : result.actions) {
    executed.actions.push_back(record.action);
    transition.actions[record.action.label()].push_back(
        std::chrono::duration<double>(record.duration).count());
  }
  transition.counts = executed.counts();
}

std::vector<std::string> walk_between(const std::vector<std::string>& controllers) {
  std::vector<std::string> walk;
  for (std::size_t i = 0; i < controllers.size(); ++i) {
    walk.push_back(controllers[i]);
    for (std::size_t k = i + 1; k < controllers.size(); ++k) {
      walk.push_back(controllers[k]);
      walk.push_back(controllers[i]);
    }
  }
  return walk;
}

std::string transitions_text(const TransitionsReport& report) {
  const std::string_view in_parentheses = report.published.empty() ? "" : "; in parentheses: published";
  return fmt::format(
      "{}: all transitions between its controllers\n\nFrom the request until all is done, mean{}:\n\n{}\n{}\n"
      "Commit: the part in which control is interrupted. Times of actions are means.\n",
      report.robot, in_parentheses, matrix_text(report), actions_text(report));
}

type::Value transitions_value(const TransitionsReport& report) {
  type::Value::List transitions;
  for_each_transition(
      report, [&](const std::string& from, const std::string& to, const MeasuredTransition& one) {
        type::Value::List seconds(one.seconds.begin(), one.seconds.end());
        type::Value::List slowest;
        for (const auto& [label, mean] : slowest_of(one))
          slowest.push_back(type::Value::map({{"action", label}, {"mean_s", mean}}));
        transitions.push_back(type::Value::map({{"from", from},
                                                {"to", to},
                                                {"mean_s", mean_of(one.seconds)},
                                                {"median_s", draw::median_of(one.seconds)},
                                                {"commit_s", draw::median_of(one.commit)},
                                                {"actions", static_cast<std::int64_t>(one.counts.total())},
                                                {"slowest", std::move(slowest)},
                                                {"seconds", std::move(seconds)}}));
      });
  return type::Value::map({{"robot", report.robot}, {"transitions", std::move(transitions)}});
}

std::string transitions_csv(const TransitionsReport& report) {
  std::string text = "from,to,repetition,milliseconds,commit_milliseconds\n";
  for_each_transition(report,
                      [&](const std::string& from, const std::string& to, const MeasuredTransition& one) {
                        for (std::size_t i = 0; i < one.seconds.size(); ++i)
                          text += fmt::format("{},{},{},{:.6f},{:.6f}\n", from, to, i + 1,
                                              one.seconds[i] * 1e3, one.commit[i] * 1e3);
                      });
  return text;
}

}  // namespace segue::cli
