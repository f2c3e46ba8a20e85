// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/ahead_of_failures.hpp>
#include <segue/convert/race_order.hpp>
#include <segue/convert/world_flow.hpp>
#include <segue/mission/world_values.hpp>
#include <segue/task_network/order.hpp>
#include <support/check_run.hpp>
#include <support/mission_runs.hpp>

#include <iterator>
#include <set>
#include <string>
#include <vector>

/// Checks that a mission run concurrently is equivalent to the sequential run. For tests only.
namespace segue::convert {

class MissionCheck {
 public:
  MissionCheck(const Ran& written, const ConcurrentRun& run, bool strict)
      : written_(written), run_(run), ran_(run.ran), strict_(strict) {}

  /// Which state ends a preemptive container, and how far the others have got until then, is a matter of
  /// time: whether both were the same.
  [[nodiscard]] bool comparable() const {
    auto expected = written_.firsts;
    std::erase_if(expected, [&](const std::string& path) { return run_.in_opaque_subtree(path); });
    if (written_.tie || expected != ran_.firsts) return false;
    return std::ranges::all_of(written_.losers, [&](const std::string& loser) {
      return run_.in_opaque_subtree(loser) || progress_in(loser, written_) == progress_in(loser, ran_);
    });
  }

  /// The first difference, or "".
  std::string difference() {
    for (const auto check :
         {&MissionCheck::end, &MissionCheck::world, &MissionCheck::happened, &MissionCheck::containers,
          &MissionCheck::outputs, &MissionCheck::log, &MissionCheck::units, &MissionCheck::ahead}) {
      if (std::string text = (this->*check)(); !text.empty()) return text;
    }
    return {};
  }

  /// Reports if it took longer than the actions in sequence, else "".
  std::string slower() {
    if (failed() && !strict_) return {};  // what acts behind a failing action takes time
    Duration limit{};
    for (const task_network::NodeResult& node : run_.network_result().nodes) {
      if (node.status != task_network::NodeStatus::NotReached) limit += node.ended - node.started;
    }
    if (ran_.makespan > limit)
      return fmt::format("took {} s, all nodes together {} s", seconds(ran_.makespan), seconds(limit));
    return {};
  }

  /// Reports if it took longer than the sequential run. Where states run side by side, they may get units in
  /// another order, so there it need not be true.
  std::string slower_than_written() {
    if ((failed() && !strict_) || ran_.makespan <= written_.makespan) return {};
    return fmt::format("took {} s instead of {} s", seconds(ran_.makespan), seconds(written_.makespan));
  }

  /// After a stop: an error in the remaining state, or "".
  std::string difference_after_stop() {
    for (const auto check : {&MissionCheck::preempted, &MissionCheck::begun, &MissionCheck::log}) {
      if (std::string text = (this->*check)(); !text.empty()) return text;
    }
    return {};
  }

 private:
  /// How far a state got: of each action in it, the executions and how many of them were preempted.
  static std::map<std::string, std::pair<std::size_t, std::ptrdiff_t>> progress_in(const std::string& state,
                                                                                   const Ran& ran) {
    std::map<std::string, std::pair<std::size_t, std::ptrdiff_t>> progress;
    for (const auto& [path, outcomes] : ran.happened) {
      if (path != state && !path.starts_with(state + "/")) continue;
      progress.emplace(path, std::pair(outcomes.size(), std::ranges::count(outcomes, "preempted")));
    }
    return progress;
  }
  [[nodiscard]] bool failed() const { return written_.result.outcome < 0; }
  static std::int64_t seconds(Duration time) { return time / std::chrono::seconds(1); }

  std::string end() {
    const mission::MissionResult& a = written_.result;
    const mission::MissionResult& b = ran_.result;
    if (a.outcome_name == b.outcome_name && a.error == b.error) return {};
    return fmt::format("outcome {} ({}) instead of {} ({})", b.outcome_name, b.error, a.outcome_name,
                       a.error);
  }

  /// After a failure, effects of what is listed as ahead() may exist already, except in strict runs.
  std::string world() {
    if (failed() && !strict_) return {};
    if (ran_.world != written_.world)
      return fmt::format("world {} instead of {}", fmt::join(ran_.world, " "),
                         fmt::join(written_.world, " "));
    if (ran_.globals == written_.globals) return {};
    return fmt::format("globals {} instead of {}", type::describe(ran_.globals),
                       type::describe(written_.globals));
  }

  std::string happened() {
    if (failed()) return {};
    auto expected = written_.happened;
    std::erase_if(expected, [&](const auto& entry) { return run_.in_opaque_subtree(entry.first); });
    if (expected == ran_.happened) return {};
    return "what happened:\n" + text_of(ran_.happened) + " instead of\n" + text_of(expected);
  }

  /// Who follows a run hears the same of containers.
  std::string containers() {
    if (failed() || ran_.has_journal || ran_.containers == written_.containers) return {};
    return fmt::format("containers that ended:\n{}\ninstead of\n{}", fmt::join(ran_.containers, "\n"),
                       fmt::join(written_.containers, "\n"));
  }

  std::string outputs() {
    if (written_.result.outputs == ran_.result.outputs) return {};
    return fmt::format("outputs {} instead of {}", type::describe(ran_.result.outputs.at(0)),
                       type::describe(written_.result.outputs.at(0)));
  }

  static std::string text_of(const std::map<std::string, std::vector<std::string>>& happened) {
    std::string text;
    for (const auto& [path, outcomes] : happened)
      text += fmt::format("  {}: {}\n", path, fmt::join(outcomes, ", "));
    return text;
  }

  /// The network's own rules, then what the mission declares: no unit is used twice, and all that were taken
  /// are given back; conflicting actions follow each other as in the program.
  std::string log() {
    const task_network::RunResult& result = run_.network_result();
    const auto beside = [this](task_network::NodeId acts, task_network::NodeId fails) {
      return beside_or_after_race(run_.plan(), acts, fails);
    };
    std::string text =
        task_network::RunCheck(run_.plan().network(), result, result, strict_, beside).difference();
    if (text.empty()) text = grants();
    if (text.empty()) text = conflicts();
    if (text.empty()) text = races();
    if (text.empty()) text = changes();
    return text;
  }

  [[nodiscard]] const mission::Action* action(task_network::NodeId node) const {
    const PlannedNode& planned = run_.plan()[node];
    if (planned.role != Role::Action) return nullptr;
    const mission::Program& program = run_.plan().program();
    return &program.mission().actions[program.node(planned.state).action];
  }

  static int count_of(const mission::Mission& mission, const std::string& resource) {
    const auto found = std::ranges::find(mission.resources, resource, &mission::Resource::name);
    return found == mission.resources.end() ? 1 : found->count;
  }

  std::string grants() {
    std::map<std::string, int> used;
    for (const task_network::LogEntry& entry : run_.network_result().log) {
      const bool start = entry.kind == task_network::LogKind::Start;
      const mission::Action* what = action(entry.node);
      if (what == nullptr || (!start && entry.kind != task_network::LogKind::End)) continue;
      if (!run_.plan()[entry.node].refused.empty()) continue;  // it never executes
      for (const mission::ResourceUse& use : what->resources) {
        if (use.operation != mission::ResourceOperation::Block) continue;
        int& units = used[use.resource] += start ? use.count : -use.count;
        if (units > count_of(run_.plan().program().mission(), use.resource))
          return fmt::format("{} got '{}', which others use", run_.plan()[entry.node].path, use.resource);
      }
    }
    for (const auto& [resource, units] : used) {
      if (units != 0) return fmt::format("{} of '{}' are still held", units, resource);
    }
    return {};
  }

  /// A node ordered after another by facts, or because one of them may touch anything, begins after its end,
  /// so there is no cycle of conflicts.
  std::string conflicts() {
    const task_network::TaskNetwork& network = run_.plan().network();
    const task_network::Order order = task_network::derive_order(network);
    const auto& nodes = run_.network_result().nodes;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const bool acts = network[task_network::NodeId{i}].kind != ActionClass::Pure;
      if (!acts || nodes[i].attempts == 0 || nodes[i].status == task_network::NodeStatus::NotReached)
        continue;
      for (const task_network::Dependency& dependency : order.before(task_network::NodeId{i})) {
        const task_network::NodeResult& from = nodes[index(dependency.from)];
        const bool senses = network[task_network::NodeId{i}].kind == ActionClass::Sensing;
        const bool guessed = dependency.reason() == task_network::Reason::Data ||
                             dependency.reason() == task_network::Reason::Condition ||
                             dependency.reason() == task_network::Reason::Resource;
        if (from.status == task_network::NodeStatus::Skipped || (senses && guessed)) continue;
        const bool begun = dependency.reason() == task_network::Reason::Resource;
        const TimePoint there = begun ? from.started : from.committed;
        const bool done = (begun && from.attempts > 0) || from.status == task_network::NodeStatus::Done ||
                          from.status == task_network::NodeStatus::Preempted;
        if (!done || there > nodes[i].started)
          return fmt::format("{} did not wait for {} ({} {})", network.label(task_network::NodeId{i}),
                             network.label(dependency.from), to_string(dependency.reason()),
                             task_network::subject_text(network, dependency));
      }
    }
    return {};
  }

  /// The values of the world that the node looks at or changes, or only those that it changes.
  [[nodiscard]] std::vector<std::string> values_of(task_network::NodeId node, bool only_changed) const {
    const PlannedNode& planned = run_.plan()[node];
    if (planned.touched != nullptr) return only_changed ? planned.touched->changed : planned.touched->all;
    const mission::Action* what = action(node);
    if (what == nullptr) return {};
    return only_changed ? mission::values_changed(*what) : mission::values_touched(*what);
  }

  /// What acts begins after all that change a value which it looks at or changes, those in parallel aside.
  std::string changes() {
    const task_network::TaskNetwork& network = run_.plan().network();
    const auto& nodes = run_.network_result().nodes;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const task_network::NodeId node{i};
      const bool acts = network[node].kind == ActionClass::Irreversible;
      if (!acts || nodes[i].attempts == 0 || !run_.plan()[node].refused.empty()) continue;
      const auto touched = values_of(node, false);
      for (std::uint32_t j = 0; j < i && !touched.empty(); ++j) {
        const task_network::NodeId before{j};
        if (mission::in_parallel(run_.plan()[node].branch.get(), run_.plan()[before].branch.get())) continue;
        std::vector<std::string> both;
        std::ranges::set_intersection(touched, values_of(before, true), std::back_inserter(both));
        const bool over = nodes[j].status == task_network::NodeStatus::Skipped ||
                          (nodes[j].status != task_network::NodeStatus::NotReached &&
                           nodes[j].committed <= nodes[i].started);
        if (!both.empty() && !over)
          return fmt::format("{} did not wait for {}, which changes {}", network.label(node),
                             network.label(before), both.front());
      }
    }
    return {};
  }

  /// The number of each execution of a preemptive container that the node is in.
  [[nodiscard]] std::set<std::uint64_t> races_of(task_network::NodeId node) const {
    const mission::Program& program = run_.plan().program();
    std::set<std::uint64_t> numbers;
    for (const auto* branch = run_.plan()[node].branch.get(); branch != nullptr;
         branch = branch->around.get()) {
      const auto kind = program.node(program.node(branch->child).parent).kind;
      if (kind == mission::StateKind::Preemptive) numbers.insert(branch->barrier);
    }
    return numbers;
  }

  /// States of a preemptive container do not wait for each other, and begin when all before has ended.
  std::string races() {
    const task_network::TaskNetwork& network = run_.plan().network();
    const task_network::Order order = task_network::derive_order(network);
    const auto& nodes = run_.network_result().nodes;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const task_network::NodeId node{i};
      const std::set<std::uint64_t> own = races_of(node);
      if (own.empty() || nodes[i].attempts == 0) continue;
      const auto in_parallel = [&](task_network::NodeId other) {
        return mission::in_parallel(run_.plan()[node].branch.get(), run_.plan()[other].branch.get());
      };
      for (const task_network::Dependency& dependency : order.before(node)) {
        const std::set<std::uint64_t> others = races_of(dependency.from);
        if (in_parallel(dependency.from) && (!own.empty() || !others.empty()))
          return fmt::format("{} would wait for {}, which runs beside it ({} {})", network.label(node),
                             network.label(dependency.from), to_string(dependency.reason()),
                             task_network::subject_text(network, dependency));
      }
      for (std::uint32_t j = 0; j < i; ++j) {
        const task_network::NodeId before{j};
        const bool inside = std::ranges::includes(races_of(before), own);
        const bool over =
            nodes[j].status == task_network::NodeStatus::Skipped || nodes[j].committed <= nodes[i].started;
        if (!inside && !over && !in_parallel(before))
          return fmt::format("{} did not wait for {}", network.label(node), network.label(before));
      }
    }
    return {};
  }

  /// After a failure, what is listed as ahead() may have used units already, except in strict runs.
  std::string units() {
    if ((failed() && !strict_) || ran_.units == written_.units) return {};
    const auto text = [](const Ran& ran) {
      std::string all;
      for (const auto& [resource, count] : ran.units)
        all += fmt::format(" {} {}", count, resource);
      return all;
    };
    return "units left:" + text(ran_) + " instead of" + text(written_);
  }

  /// What acted although an earlier action failed is in the list that is known before the run, and was not
  /// declared strict.
  std::string ahead() {
    const auto failed_node = run_.network_result().failed;
    if (!failed_node) return {};
    const task_network::TaskNetwork& network = run_.plan().network();
    const auto known = ahead_of_failures(run_.plan().shared_program()).value();
    const std::string& failed = network.name_of(*failed_node);
    for (std::uint32_t i = index(*failed_node) + 1; i < run_.network_result().nodes.size(); ++i) {
      const task_network::NodeId node{i};
      const PlannedNode& planned = run_.plan()[node];
      const bool executes = planned.role == Role::Action || planned.role == Role::OpaqueSubtree;
      if (!executes || !planned.refused.empty() || beside_or_after_race(run_.plan(), node, *failed_node))
        continue;
      if (!task_network::has_acted(network, run_.network_result(), node)) continue;
      const auto entry =
          std::ranges::find(known.pairs, network.name_of(node), &task_network::NamedActsAhead::acts);
      const bool listed =
          entry != known.pairs.end() && std::ranges::find(entry->fails, failed) != entry->fails.end();
      if (known.complete && !listed)
        return fmt::format("{} acted although {} failed, and is not listed", network.name_of(node), failed);
      if (is_strict(node)) return network.name_of(node) + " is strict and acted ahead of a failure";
    }
    return {};
  }

  [[nodiscard]] bool is_strict(task_network::NodeId node) const {
    const mission::Program& program = run_.plan().program();
    const mission::Action* what = action(node);
    bool strict = what != nullptr && what->strict;
    for (auto state = run_.plan()[node].state; state != mission::kNoState; state = program.node(state).parent)
      strict = strict || program.state(state).strict;
    return strict;
  }

  std::string preempted() {
    const bool ended = ran_.result.outcome_name == written_.result.outcome_name;  // it was over before
    if (ran_.result.outcome == mission::kPreempted || ended) return {};
    return "outcome " + ran_.result.outcome_name + " after a stop";
  }

  /// The executed actions are those of the sequential run, and none begins after the stop.
  std::string begun() {
    std::map<std::string, std::size_t> seen;
    std::string text;
    run_.for_each_action([&](task_network::NodeId node, const std::string& outcome) {
      const PlannedNode& planned = run_.plan()[node];
      const std::size_t place = seen[std::string(planned.path)]++;
      if (!all_before_are_known(node) || outcome == "preempted") return;
      const auto found = written_.happened.find(std::string(planned.path));
      const bool there = found != written_.happened.end() && place < found->second.size();
      const bool same = there ? found->second[place] == outcome : failed();  // it acted behind the failure
      if (!same) text = fmt::format("{} ended as {}", run_.plan().network().label(node), outcome);
    });
    const TimePoint stopped = run_.stopped();
    if (stopped == TimePoint::max()) return "the node that stopped it never began";
    for (const task_network::LogEntry& entry : run_.network_result().log) {
      if (entry.kind == task_network::LogKind::Start && entry.when > stopped)
        text = run_.plan().network().label(entry.node) + " began after the stop";
    }
    return text;
  }

  /// Whether all nodes of that path that precede it in the plan have ended or were skipped.
  [[nodiscard]] bool all_before_are_known(task_network::NodeId node) const {
    for (std::uint32_t i = 0; i < index(node); ++i) {
      const auto status = run_.network_result().nodes[i].status;
      const bool known = status == task_network::NodeStatus::Done ||
                         status == task_network::NodeStatus::Skipped ||
                         status == task_network::NodeStatus::Preempted;
      if (!known && run_.plan()[task_network::NodeId{i}].path == run_.plan()[node].path) return false;
    }
    return true;
  }

  const Ran& written_;
  const ConcurrentRun& run_;
  const Ran& ran_;
  const bool strict_;
};

}  // namespace segue::convert
