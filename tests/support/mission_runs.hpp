// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/fnv1a.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/convert/concurrent_run.hpp>

#include <support/kept_numbers.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// Runs missions with both engines and with actions whose results depend only on their inputs. For tests
/// only.
namespace segue::convert {

inline std::uint64_t digest(std::string_view text, std::uint64_t number) {
  const std::uint64_t hash = fnv1a(text, kFnvBasis ^ number);
  return hash ^ (hash >> 29);
}

/// Follows the facts of a run: a digest of how often each has become true and false.
class ChangeCount final : public mission::WorldData {
 public:
  [[nodiscard]] std::shared_ptr<mission::WorldData> clone() const override {
    return std::make_shared<ChangeCount>(*this);
  }
  void changed(const std::string& fact, bool holds) override { count += digest(fact, holds ? 1 : 2); }
  std::uint64_t count = 0;
};

/// How long a second of an answer takes.
inline Duration answer_second = std::chrono::seconds(1);

/// Ends as its state and inputs determine, with any outcome, an abort, an exception or an invalid result,
/// after up to four seconds. If shared, it also reads and writes a global variable for each resource that it
/// holds exclusively, or common ones if it may touch anything, so that its result depends on the order of
/// execution. If it remembers, which it may do whatever it declares, it uses the variable that its input
/// names in various ways. If it keeps, it stands for a script with a persistent variable.
class Answers final : public mission::ActionRunner {
 public:
  enum class Kind : std::uint8_t { Mix, Shared, Later, Remember, Keep };
  using AtStart = std::function<void(const mission::ActionCall&)>;
  explicit Answers(Kind kind, AtStart at_start = {}) : kind_(kind), at_start_(std::move(at_start)) {}

  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    if (at_start_) at_start_(call);
    mission::Ending ending;
    const std::uint64_t number = kind_ == Kind::Keep ? keep(call, read(call), ending) : read(call);
    const bool nothing = (number >> 36) % 8 == 0;
    call.set_output("y", nothing ? type::Value() : type::Value(static_cast<std::int64_t>(number % 100)));
    if (kind_ != Kind::Keep) throw_by(number);  // what scripts throw ends in their process
    ending.outcome = static_cast<mission::Outcome>((number >> 8) % call.action().outcomes.size());
    if ((number >> 16) % 12 == 0) {
      ending.outcome = mission::kAborted;
      ending.error = fmt::format("failed at {}", number % 100);
    }
    if ((number >> 48) % 60 == 0) ending.outcome = 77;
    if (kind_ != Kind::Later) {
      const bool whole = (number >> 52) % 4 == 0;  // some end at the same time
      call.end_after(
          whole ? answer_second * ((number >> 24) % 5) : answer_second * ((number >> 24) % 4999) / 1000,
          ending);
      return std::nullopt;
    }
    std::vector<type::Value> outputs(call.outputs().begin(), call.outputs().end());
    const mission::Completer complete = call.defer([] {});
    if ((number >> 32) % 5 == 0) ending = {mission::kAborted, "its worker died"};
    complete(ending, outputs);
    complete({0, {}}, std::move(outputs));  // in vain
    return std::nullopt;
  }

 private:
  static void throw_by(std::uint64_t number) {
    if ((number >> 40) % 40 == 0) throw std::runtime_error(fmt::format("threw {}", number % 100));
    if ((number >> 40) % 40 == 1) throw number;  // NOLINT(hicpp-exception-baseclass): anything may come
  }

  std::uint64_t read(mission::ActionCall& call) const {
    const type::Value& x = call.input("x");
    std::uint64_t number = digest(call.path(), x.is_integer() ? static_cast<std::uint64_t>(x.as_int()) : 77);
    const type::Value& error = call.input("error");
    if (error.is_string()) number = digest(error.as_string(), number);
    number = sense(call, number);
    if (kind_ == Kind::Remember) return remember(call, number);
    if (kind_ != Kind::Shared) return number;
    for (const std::string& name : own(call.action())) {
      const auto before = call.globals().get(name);
      number = digest(name, number ^ integer(before));
      (void)call.globals().set(name, type::Value(static_cast<std::int64_t>(number >> 2)));
    }
    return number;
  }

  /// Mostly looks at the world, if it may.
  static std::uint64_t sense(const mission::ActionCall& call, std::uint64_t number) {
    const bool looks = call.action().reads_world || !call.action().reads_data.empty();
    if (!looks || (number >> 12) % 4 == 0) return number;
    const auto world = call.world().value();
    for (const std::string& fact : world.facts())
      number = digest(fact, number);
    for (const auto& [name, data] : world.data())
      number = digest(name + type::to_json(data->shown()), number);
    const auto changes = world.attached<ChangeCount>("changes");
    return changes ? digest("", number ^ changes->count) : number;
  }

  static std::uint64_t integer(const std::optional<type::Value>& value) {
    return value && value->is_integer() ? static_cast<std::uint64_t>(value->as_int()) : 0;
  }

  /// Reads the variable, all variables or none; writes it, erases it, locks it or leaves it as it is.
  static std::uint64_t remember(mission::ActionCall& call, std::uint64_t number) {
    const type::Value& named = call.input("variable");
    const std::string name = named.is_string() ? named.as_string() : "p0";
    mission::Globals& globals = call.globals();
    const std::uint64_t way = number >> 44;
    if (way % 4 != 0) number = digest(name, number ^ integer(globals.get(name)));
    if (way % 16 == 1) {
      const type::Value all = globals.snapshot();
      for (const std::string_view each : {"p0", "p1"}) {
        const type::Value* value = all.find(each);
        number = digest(each, number ^ (value == nullptr ? 1 : integer(*value)));
      }
    }
    if (way % 3 != 0) (void)globals.set(name, type::Value(static_cast<std::int64_t>(number >> 2)));
    if (way % 32 == 7) (void)globals.erase(name);
    if (way % 8 == 3) {
      if (const auto key = globals.lock(name, Duration::zero())) {
        (void)globals.set(name, type::Value(static_cast<std::int64_t>(number >> 3)), *key);
        (void)globals.unlock(name, *key);
      }
    }
    return number;
  }

  /// Uses what its last execution has left, and mostly leaves something else; or does neither.
  std::uint64_t keep(const mission::ActionCall& call, std::uint64_t number, mission::Ending& ending) {
    kept_.update();
    std::uint64_t from = 0;
    const auto before = kept_.before(call, from);
    if ((number >> 44) % 4 == 0) return number;
    if (!before) return number;  // it is repeated
    number = digest("", number ^ *before);
    kept_.leave(call, from, (number >> 50) % 4 == 0 ? *before : number >> 2, ending);
    return number;
  }

  /// The resources that it holds exclusively while it runs, in program order.
  static std::vector<std::string> own(const mission::Action& action) {
    if (action.resources.empty() && action.effects.empty() && action.preconditions.empty() &&
        action.changes.empty())
      return {"all", "p0", "p1"};
    for (const mission::ResourceUse& use : action.resources) {
      if (use.operation == mission::ResourceOperation::Block && use.resource == "r0") return {"r0"};
    }
    return {};
  }

  Kind kind_;
  AtStart at_start_;
  KeptNumbers kept_;
};

inline mission::Runners answering(const Answers::AtStart& at_start = {}) {
  mission::Runners runners;
  runners.add("mix", std::make_shared<Answers>(Answers::Kind::Mix, at_start));
  runners.add("shared", std::make_shared<Answers>(Answers::Kind::Shared, at_start));
  runners.add("remember", std::make_shared<Answers>(Answers::Kind::Remember, at_start));
  runners.add("later", std::make_shared<Answers>(Answers::Kind::Later, at_start));
  runners.set_scripts(std::make_shared<Answers>(Answers::Kind::Keep, at_start));
  return runners;
}

/// The result of a mission, with the outcomes of actions by their paths, in program order.
struct Ran {
  mission::MissionResult result;
  std::vector<std::string> world;
  type::Value globals;
  std::map<std::string, std::vector<std::string>> happened;
  std::set<std::string>
      open_containers;  ///< that were reported to have begun, and not to have ended: "a/b#0"
  std::multiset<std::string> containers;  ///< that were reported to have ended: "a/b: success"
  std::map<mission::StateIndex, std::set<std::string>> ends;  ///< the outcomes of each action
  std::map<std::string, std::int64_t, std::less<>> units;     ///< that are left, where they are not one
  bool has_journal = false;  ///< which may have supplied ends that are not reported
  Duration makespan{};
  bool tie = false;                 ///< states of a preemptive container ended at the same time, or at once
  std::vector<std::string> firsts;  ///< the paths of states that have ended their preemptive containers
  std::vector<std::string> losers;  ///< run sequentially: the paths of those that were preempted by them
};

/// Notes which state ended the execution of a preemptive container first, and which ones it preempted.
inline void note_race(const mission::Program& program, const mission::History& history, std::uint32_t race,
                      Ran& ran) {
  const auto& items = history.items();
  bool decided = false;
  for (std::uint32_t i = race + 1; i < items.size(); ++i) {
    std::uint32_t state = i;  // of the container
    while (items[state].parent != mission::History::kNone && items[state].parent != race)
      state = items[state].parent;
    if (items[state].parent != race) continue;
    const bool lost = items[state].outcome == mission::kPreempted;
    const bool just_ended = items[i].end == items[race].end && items[i].outcome != mission::kPreempted;
    ran.tie = ran.tie || items[i].began == items[race].end || (lost && just_ended);
    if (items[i].parent != race) continue;
    const bool first = items[i].outcome != mission::kPreempted;
    ran.tie = ran.tie || (first && decided);
    decided = decided || first;
    (first ? ran.firsts : ran.losers).push_back(history.path(program, i));
  }
}

/// Notes which containers end; those that end without having begun, and the other way round, are wrong.
inline void note_container(const mission::StateEvent& event, Ran& ran) {
  if (!event.is_container) return;
  const std::string execution = fmt::format("{}#{}", event.path, event.iteration);
  if (event.kind == mission::StateEvent::Kind::Began) {
    if (!ran.open_containers.insert(execution).second) ran.containers.insert(execution + " began twice");
  } else {
    const bool may_not_begin = event.outcome == mission::kAbortedName;
    if (ran.open_containers.erase(execution) == 0 && !may_not_begin)
      ran.containers.insert(execution + " ended without having begun");
    ran.containers.insert(fmt::format("{}: {}", event.path, event.outcome));
  }
}

inline Ran run_as_written(const std::shared_ptr<const mission::Program>& program) {
  VirtualClock clock;
  mission::EngineOptions options;
  options.clock = &clock;
  options.world_data.emplace("changes", std::make_shared<ChangeCount>());
  Ran ran;
  options.observe = [&ran](const mission::StateEvent& event) { note_container(event, ran); };
  auto engine = mission::Engine::create(program, answering(), options).value();
  const TimePoint begin = clock.now();
  engine->run();
  for (const std::string& execution : ran.open_containers)
    ran.containers.insert(execution + " never ended");
  ran.result = engine->result();
  ran.makespan = clock.now() - begin;
  ran.world.assign(engine->world().facts().begin(), engine->world().facts().end());
  ran.globals = engine->globals().snapshot();
  for (const auto& [resource, count] : engine->units().counts())
    if (count != 1) ran.units[resource] = count;
  const auto& items = engine->history().items();
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    if (!mission::is_leaf(program->node(items[i].state).kind)) continue;
    ran.ends[items[i].state].insert(program->outcome_name(items[i].state, items[i].outcome));
    ran.happened[engine->history().path(*program, i)].push_back(
        program->outcome_name(items[i].state, items[i].outcome));
  }
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    if (program->node(items[i].state).kind == mission::StateKind::Preemptive)
      note_race(*program, engine->history(), i, ran);
  }
  std::ranges::sort(ran.firsts);
  return ran;
}

/// A concurrent run with its final state. It is stopped once `stop_at` callbacks have begun,
/// and where a planted fault makes a loop endless.
class ConcurrentRun {
 public:
  ConcurrentRun(const std::shared_ptr<const mission::Program>& program, RunOptions options,
                std::uint64_t stop_at = 0) {
    options.log = true;
    ran.has_journal = options.journal != nullptr;
    options.world_data.emplace("changes", std::make_shared<ChangeCount>());
    const auto at_start = [this, stop_at](const mission::ActionCall& call) {
      ++begun_at_[call.path()];
      if (++begun_ != stop_at) return;
      stopped_in_ = call.path();
      run_->stop();
    };
    options.observe = [this, actions = 0](const mission::StateEvent& event) mutable {
      note_container(event, ran);
      if (++actions > kTooManyEvents) run_->stop();
    };
    run_ = Run::create(program, answering(at_start), {}, options).value();
    ran.result = run_->run();
    ran.makespan = network_result().makespan;
    ran.world = network_result().world.texts(plan().network().facts);
    ran.globals = run_->globals().snapshot();
    const task_network::ResourceTable& resources = plan().network().resources;
    for (std::uint32_t i = 0; i < resources.size(); ++i)
      if (network_result().units[i] != 1 && !plan().network().resources[task_network::ResourceId{i}].lent)
        ran.units[resources.name(task_network::ResourceId{i})] = network_result().units[i];
    for_each_action([&](task_network::NodeId node, const std::string& outcome) {
      ran.happened[std::string(plan()[node].path)].push_back(outcome);
    });
    for (const mission::Execution& first : plan().race_record().firsts)
      ran.firsts.push_back(first.path);
    std::ranges::sort(ran.firsts);
  }

  [[nodiscard]] const MissionPlan& plan() const { return run_->plan(); }
  [[nodiscard]] const task_network::RunResult& network_result() const { return run_->network_result(); }
  [[nodiscard]] std::uint64_t begun() const { return begun_; }
  [[nodiscard]] std::size_t begun_at(const std::string& path) const {
    const auto found = begun_at_.find(path);
    return found == begun_at_.end() ? 0 : found->second;
  }

  /// When it was stopped: the begin of the last execution of the node that requested it.
  [[nodiscard]] TimePoint stopped() const {
    TimePoint when = TimePoint::max();
    for (const task_network::LogEntry& entry : network_result().log) {
      const std::string around = std::string(plan()[entry.node].path);
      const bool asked =
          stopped_in_ && (around.empty() || around == *stopped_in_ || stopped_in_->starts_with(around + "/"));
      if (entry.kind == task_network::LogKind::Start && asked) when = entry.when;
    }
    return when;
  }

  /// Whether events at that path are not reported, since it runs sequentially.
  [[nodiscard]] bool in_opaque_subtree(const std::string& path) const {
    for (std::uint32_t i = 0; i < plan().network().size(); ++i) {
      const PlannedNode& node = plan()[task_network::NodeId{i}];
      if (node.role != Role::OpaqueSubtree) continue;
      if (node.path.empty() || path.starts_with(std::string(node.path) + "/")) return true;
    }
    return false;
  }

  /// Calls visit(node, outcome) for all actions that have ended.
  template <class Visit>
  void for_each_action(Visit&& visit) const {
    const task_network::RunResult& result = network_result();
    for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
      const task_network::NodeId node{i};
      const auto status = result.nodes[i].status;
      if (plan()[node].role != Role::Action) continue;
      if (status == task_network::NodeStatus::NotReached || status == task_network::NodeStatus::Skipped)
        continue;
      const auto outcome = plan().outcome(node, result.nodes[i].outcome);
      visit(node, plan().program().outcome_name(plan()[node].state, outcome));
    }
  }

  Ran ran;

 private:
  static constexpr int kTooManyEvents = 3'000;

  std::unique_ptr<Run> run_;
  std::uint64_t begun_ = 0;
  std::map<std::string, std::size_t> begun_at_;
  std::optional<std::string> stopped_in_;
};

}  // namespace segue::convert
