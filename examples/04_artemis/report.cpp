// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include "processes.hpp"

#include <segue/base/text.hpp>
#include <segue/distributed/gateways.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <cstdio>
#include <set>

namespace demo {
namespace {

using namespace segue;
using model::ActionKind;

constexpr std::size_t kLineWidth = 110;
constexpr std::size_t kShown = 6;  // actions listed of each kind, unless all are to be printed

double milliseconds(Duration duration) {
  return static_cast<double>(duration.count()) / 1e6;
}

std::vector<std::string> labels_of(const runtime::SwitchResult& result, ActionKind kind) {
  std::vector<std::string> labels;
  for (const runtime::ActionRecord& record : result.actions) {
    if (record.action.kind != kind) continue;
    // "stop wbc" -> "wbc": the kind is printed once, at the start of the line.
    const std::string label = record.action.label();
    labels.push_back(label.substr(std::min(label.size(), to_string(kind).size() + 1)));
  }
  return labels;
}

/// The names after a heading, wrapped to the width of the page.
void print_wrapped(const std::string& heading, const std::vector<std::string>& names) {
  std::string line = heading;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string word = names[i] + (i + 1 < names.size() ? "," : "");
    if (i > 0 && line.size() + word.size() + 1 > kLineWidth) {
      std::puts(line.c_str());
      line = std::string(heading.size(), ' ');
    }
    line += ' ' + word;
  }
  std::puts(line.c_str());
}

int count_of(const model::ActionCounts& counts, const std::string& column) {
  if (column == "state_changes") return counts.state_changes();
  if (column == "total") return counts.total();
  for (std::size_t kind = 0; kind < model::kActionKindNames.size(); ++kind) {
    if (model::kActionKindNames[kind] == column) return counts.by_kind[kind];
  }
  return -1;
}

/// Whether an action serves connections between hosts only, which the paper's rover has none of.
bool is_for_links(const model::Action& action) {
  if (const auto* what = std::get_if<model::DeploymentAction>(&action.what))
    return what->deployment.process == distributed::kGatewayProcess;
  if (const auto* what = std::get_if<model::ConnectionAction>(&action.what))
    return distributed::is_link_task(what->connection.to.task);
  return action.task() != nullptr && distributed::is_link_task(*action.task());
}

model::ActionCounts counts_of(const runtime::SwitchResult& result) {
  model::ActionCounts counts;
  for (const auto& record : result.actions) {
    if (!is_for_links(record.action)) ++counts.by_kind.at(static_cast<std::size_t>(record.action.kind));
  }
  return counts;
}

/// The processes that a network needs: "slam", on other hosts "slam@a", and on each of several hosts the one
/// that connects it with the others.
std::set<std::string> processes_of(const model::Network& network) {
  std::set<std::string> names;
  std::set<std::string> used;
  for (const auto& deployment : network.deployments) {
    const bool is_here = deployment.host == model::kLocalHost;
    const std::string place = is_here ? "" : "@" + deployment.host.str();
    names.insert(deployment.process.str() + place);
    used.insert(place);
  }
  for (const auto& place : used) {
    if (used.size() > 1) names.insert(distributed::kGatewayProcess.str() + place);
  }
  return names;
}

/// What each host holds: "a: 5 processes, 12 tasks".
void print_hosts(const model::Network& network) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> hosts;
  for (const auto& deployment : network.deployments)
    ++hosts[deployment.host.str()].first;
  for (const auto& [task, process] : model::task_processes(network))
    ++hosts[process.host.str()].second;
  std::string line = "  hosts        ";
  for (const auto& [name, held] : hosts) {
    line += (line.back() == ' ' ? " " : "; ") + name + ": " + std::to_string(held.first) + " processes, " +
            std::to_string(held.second) + " tasks";
  }
  std::puts(line.c_str());
}

std::set<std::string> named_tasks(const runtime::SwitchResult& result) {
  std::set<std::string> names;
  for (const auto& record : result.actions) {
    if (const model::TaskId* task = record.action.task()) names.insert(task->str());
  }
  return names;
}

}  // namespace

Flow measure_flow(runtime::EmbeddedRobot& robot) {
  Flow flow;
  for (const auto& connection : robot.host().connections())
    flow.samples += connection.read;
  for (const auto& task : robot.host().tasks()) {
    flow.missed[task.id.str()] = task.timing.missed;
    flow.cycles[task.id.str()] = task.timing.cycles;
  }
  return flow;
}

Result<Report> Report::create(const std::filesystem::path& table, bool everything, bool in_process,
                              std::vector<std::string> hosts) {
  auto document = type::load_yaml(table);
  if (!document) return document.error();
  Report report;
  report.everything_ = everything;
  report.in_process_ = in_process;
  report.hosts_ = std::move(hosts);
  const type::Value* rows = document->find("transitions");
  if (rows == nullptr || !rows->is_list())
    return fail(ErrorCode::ParseError, table.string() + " has no list 'transitions'");
  for (const type::Value& row : rows->as_list()) {
    Columns columns;
    for (const auto& [name, value] : row.as_map()) {
      if (value.is_integer()) columns.emplace_back(name, static_cast<int>(value.as_int()));
    }
    report.table_[{row.find("from")->as_string(), row.find("to")->as_string()}] = std::move(columns);
  }
  return report;
}

void Report::introduce(runtime::EmbeddedRobot& robot) {
  std::printf(
      "The Artemis rover (Wirkus et al. 2020): four controllers, switched online %s.\n"
      "Every component is a stand-in: it has the ports, connections and life cycle, but no driver.\n\n",
      in_process_ ? "in one process" : "in processes of their own");
  if (!hosts_.empty()) {
    std::printf("Hosts: %s. They are daemons on this computer; samples between them travel by DDS.\n\n",
                listed(hosts_).c_str());
  }
  std::printf("  %-22s %6s %10s %12s\n", "controller", "tasks", "processes", "connections");
  for (const auto& name : robot.runtime().controllers()) {
    const auto network = robot.runtime().controller(name);
    if (!network) continue;
    std::printf("  %-22s %6zu %10zu %12zu\n", name.str().c_str(), network->tasks.size(),
                network->deployments.size(), network->connections.size());
  }
}

bool Report::started(const runtime::SwitchResult& result) {
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.why().c_str());
    return false;
  }
  std::printf("\nStarted %s from nothing: %zu actions in %.1f ms.\n", result.to.str().c_str(),
              result.actions.size(), milliseconds(result.duration));
  return true;
}

void Report::print_actions(const runtime::SwitchResult& result) const {
  for (std::size_t kind = 0; kind < model::kActionKindNames.size(); ++kind) {
    auto names = labels_of(result, static_cast<ActionKind>(kind));
    if (names.empty()) continue;
    char heading[40];
    std::snprintf(heading, sizeof heading, "  %-12s %3zu ",
                  std::string(model::kActionKindNames[kind]).c_str(), names.size());
    if (!everything_ && names.size() > kShown) {
      const std::size_t hidden = names.size() - kShown;
      names.resize(kShown);
      names.push_back("... and " + std::to_string(hidden) + " more");
    }
    print_wrapped(heading, names);
  }
}

void Report::print_counts(const model::ActionCounts& counts, const Columns& paper) {
  std::string ours = "  counts here   ";
  std::string theirs = "  paper Table 7 ";
  std::string head = "                ";
  bool all_equal = true;
  for (const auto& [column, expected] : paper) {
    const int counted = count_of(counts, column);
    ++numbers_;
    numbers_equal_ += counted == expected ? 1 : 0;
    all_equal = all_equal && counted == expected;
    const std::size_t width = column.size() + 2;
    auto padded = [&](const std::string& text) {
      return std::string(width - std::min(width, text.size()), ' ') + text;
    };
    head += padded(column);
    ours += padded(std::to_string(counted));
    theirs += padded(std::to_string(expected));
  }
  std::printf("%s\n%s\n%s   %s\n", head.c_str(), ours.c_str(), theirs.c_str(),
              all_equal ? "equal" : "DIFFERENT");
}

int Report::note_undisturbed(const runtime::SwitchResult& result, const Flow& before, const Flow& after) {
  const std::set<std::string> named = named_tasks(result);
  int untouched = 0;
  for (const auto& [task, cycles] : before.cycles) {
    if (named.contains(task)) continue;
    ++untouched;
    const auto now = after.cycles.find(task);
    // A restarted task counts its updates from zero.
    const bool kept = now != after.cycles.end() && now->second >= cycles;
    ++(kept ? undisturbed_ : disturbed_);
  }
  return untouched;
}

bool Report::switched(const runtime::SwitchResult& result, const Flow& before, const Flow& after) {
  ++transitions_;
  std::printf("\n%2d. %s -> %s\n", transitions_, result.from.str().c_str(), result.to.str().c_str());
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.why().c_str());
    return false;
  }
  const model::ActionCounts counts = counts_of(result);
  print_actions(result);
  print_counts(counts, table_[{result.from.str(), result.to.str()}]);
  std::printf("  time          %.2f ms for %d actions, computed in %.2f ms; %d tasks went on untouched\n",
              milliseconds(result.duration), counts.total(), milliseconds(result.solve_time),
              note_undisturbed(result, before, after));
  actions_ += counts.total();
  longest_ = std::max(longest_, result.duration);
  switching_ += result.duration;
  samples_before_ = after.samples;
  return true;
}

void Report::check_processes(runtime::EmbeddedRobot& robot) {
  const model::Network network = robot.runtime().belief();
  const std::set<std::string> expected = in_process_ ? std::set<std::string>() : processes_of(network);
  const Processes found = look_at_processes();
  const std::size_t pools = in_process_ ? 0 : 2 * (expected.size() + 1);
  auto wrong = robot.runtime().observed_differences();
  if (found.names != expected) {
    wrong.push_back("the operating system shows other processes: " + std::to_string(found.names.size()));
  }
  if (found.pools != pools) {
    wrong.push_back(std::to_string(found.pools) + " pools of shared memory are mapped, expected " +
                    std::to_string(pools));
  }
  std::printf("  processes     %zu, %zu pools of shared memory, %zu tasks, %zu connections: %s\n",
              found.names.size(), found.pools, network.tasks.size(), network.connections.size(),
              wrong.empty() ? "exactly what the controller says" : "NOT what the controller says");
  if (!hosts_.empty() && !network.empty()) print_hosts(network);
  for (const auto& sentence : wrong)
    std::printf("                %s\n", sentence.c_str());
  ++looks_;
  wrong_looks_ += wrong.empty() ? 0 : 1;
  if (!network.empty()) {
    fewest_ = fewest_ == 0 ? found.names.size() : std::min(fewest_, found.names.size());
    most_ = std::max(most_, found.names.size());
  }
}

void Report::flowed(const Flow& flow) {
  const std::uint64_t samples = flow.samples - std::min(flow.samples, samples_before_);
  samples_ += samples;
  std::printf("  samples       %llu delivered while it ran\n", static_cast<unsigned long long>(samples));
}

void Report::ended(const runtime::SwitchResult& result) {
  std::printf("\nStopped and cleaned up everything: %zu actions in %.1f ms.\n", result.actions.size(),
              milliseconds(result.duration));
}

bool Report::summarise() {
  const bool counts_equal = numbers_ > 0 && numbers_equal_ == numbers_;
  std::printf(
      "\nSummary\n"
      "  %d transitions between four controllers, %d actions in all, none of them written by hand: the "
      "runtime\n"
      "  compares what runs with what is wanted and computes the shortest way.\n"
      "  %d of %d numbers equal the paper's Table 7.\n"
      "  Switching took %.1f ms in total, the longest transition %.1f ms (the rover's own drivers needed up "
      "to 4.2 s).\n"
      "  %d times a running task was not named by a transition; %s.\n"
      "  %llu samples were delivered between the switches.\n",
      transitions_, actions_, numbers_equal_, numbers_, milliseconds(switching_), milliseconds(longest_),
      undisturbed_ + disturbed_, disturbed_ == 0 ? "each time it simply went on" : "some were disturbed",
      static_cast<unsigned long long>(samples_));
  if (!in_process_) {
    std::printf(
        "  The controllers ran in %zu to %zu processes. %d times the operating system and the processes were "
        "asked;\n"
        "  %s.\n",
        fewest_, most_, looks_,
        wrong_looks_ == 0 ? "each time there was exactly what the controller says, and nothing was left over"
                          : "something was missing or left over");
  }
  return counts_equal && disturbed_ == 0 && wrong_looks_ == 0;
}

}  // namespace demo
