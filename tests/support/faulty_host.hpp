// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task_host/task_host.hpp>

#include <support/forwarding_host.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::testing {

/// The kinds of fault at an action.
enum class Fault {
  Refused,     ///< the action fails without effect, once
  Doubted,     ///< the action takes effect but is reported as failed, once
  Persistent,  ///< the action fails at every attempt, also when undoing
  Slow,        ///< exceeds its deadline, and has taken effect at the next snapshot
  Late,        ///< as Slow, but the first snapshot still shows its task as hanging
  Lost,        ///< as Late, but the action has no effect
  Hangs,       ///< never returns; a hanging task is Fatal until its process ends
  Dies,        ///< its process dies
  DiesAgain,   ///< its process dies at every attempt
  ServerDies   ///< from then on no process can be started or ended
};
inline constexpr std::array kFaults = {Fault::Refused,   Fault::Doubted,   Fault::Persistent, Fault::Slow,
                                       Fault::Late,      Fault::Lost,      Fault::Hangs,      Fault::Dies,
                                       Fault::DiesAgain, Fault::ServerDies};
inline constexpr std::array<std::string_view, kFaults.size()> kFaultNames = {
    "refused", "doubted", "persistent", "slow", "late", "lost", "hangs", "dies", "dies again", "server dies"};

/// A host that injects a fault at one action. Simulates the processes of the network, although all tasks live
/// in `inner`, and behaves like the host of deployed tasks.
class FaultyHost final : public ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;

  /// Injects the fault at the action of this label, once or at every attempt, according to the fault.
  void arm(Fault fault, std::string label) {
    const Lock lock(mutex_);
    fault_ = fault;
    label_ = std::move(label);
    struck_ = false;
    place_.reset();
    passed_.clear();
  }
  /// Ends the fault: hooks have returned, and processes can be started.
  void heal() {
    const Lock lock(mutex_);
    fault_.reset();
    hanging_.clear();
    server_is_down_ = false;
  }
  [[nodiscard]] bool struck() const {
    const Lock lock(mutex_);
    return struck_;
  }
  /// The process of the fault.
  [[nodiscard]] std::optional<model::DeploymentKey> place() const {
    const Lock lock(mutex_);
    return place_;
  }
  /// The actions that reached the tasks since arm().
  [[nodiscard]] std::vector<model::Action> passed() const {
    const Lock lock(mutex_);
    return passed_;
  }

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    std::vector<model::Action> passed;
    std::vector<std::size_t> index_of;
    std::set<std::size_t> doubted;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      model::Action action = actions[i];
      const auto [passes, doubt, answer] = meet(action);
      if (!passes) {
        completed({{i, answer}});
        continue;
      }
      if (doubt) doubted.insert(i);
      passed.push_back(std::move(action));
      index_of.push_back(i);
    }
    {
      const Lock lock(mutex_);
      passed_.insert(passed_.end(), passed.begin(), passed.end());
    }
    inner_.begin_all(std::move(passed), deadline, [index_of, doubted, completed](auto ended) {
      for (auto& one : ended) {
        one.index = index_of.at(one.index);
        if (one.outcome && doubted.contains(one.index)) one.outcome = broken();
      }
      completed(std::move(ended));
    });
  }

  [[nodiscard]] model::Network observe() const override {
    std::vector<model::Action> due;
    {
      const Lock lock(mutex_);
      std::erase_if(hanging_, [&](Hanging& one) {
        if (one.snapshots-- > 0) return false;
        if (one.is_done) due.push_back(one.action);
        return true;
      });
    }
    for (const auto& action : due)
      static_cast<void>(inner_.perform(action, patience()));
    model::Network seen = inner_.observe();
    const Lock lock(mutex_);
    for (const auto& one : hanging_) {
      const auto* id = one.action.task();
      model::Task* task = id == nullptr ? nullptr : seen.find_task(*id);
      if (task != nullptr) task->state = TaskState::Fatal;
    }
    return seen;
  }

  /// Drops hanging tasks as the real host does.
  void conclude(const model::Transition& transition) override {
    const model::Network truth = inner_.observe();
    for (const auto& id : transition.removes) {
      const model::Task* task = truth.find_task(id);
      if (task == nullptr || !forget_hanging(id)) continue;
      if (task->state == TaskState::Running) take_down(model::ActionKind::Stop, id);
      if (is_configured(task->state)) take_down(model::ActionKind::Cleanup, id);
    }
    inner_.conclude(transition);
  }

  void set_listener(Listener listener) override {
    {
      const Lock lock(mutex_);
      listener_ = listener;
    }
    inner_.set_listener(std::move(listener));
  }

 private:
  struct Hanging {
    model::Action action;
    std::optional<model::DeploymentKey> process;
    int snapshots = 0;  ///< number of snapshots that show it hanging
    bool is_done = false;
  };
  struct Meeting {
    bool passes = true;
    bool doubted = false;
    Result<void> answer{};
  };

  static TimePoint patience() { return RealClock::instance().now() + std::chrono::seconds(60); }
  static Result<void> broken() { return fail(ErrorCode::IoError, "a fault"); }
  static Result<void> overdue() { return fail(ErrorCode::DeadlineExceeded, "a hook has not returned"); }
  static Result<void> gone() { return fail(ErrorCode::Unavailable, "the process cannot be reached"); }
  static bool is_of_process(const model::Action& action) {
    return std::holds_alternative<model::DeploymentAction>(action.what);
  }

  /// Decides about an action; may change it.
  Meeting meet(model::Action& action) {
    const auto place = place_of(action);
    Fault fault{};
    {
      const Lock lock(mutex_);
      if (is_of_process(action) && server_is_down_) return {false, false, gone()};
      if (is_held_up(action)) return {false, false, overdue()};
      if (!strikes(action)) {
        if (action.kind == model::ActionKind::Undeploy) end_hanging(action);
        return {};
      }
      struck_ = true;
      place_ = place;
      fault = *fault_;
    }
    return strike(fault, action, place);
  }

  Meeting strike(Fault fault, const model::Action& action, const std::optional<model::DeploymentKey>& place) {
    switch (fault) {
      case Fault::Refused:
      case Fault::Persistent:
        return {false, false, broken()};
      case Fault::Doubted:
        return {true, true, {}};
      case Fault::Dies:
      case Fault::DiesAgain:
        return die(action, place);
      case Fault::ServerDies: {
        const Lock lock(mutex_);
        server_is_down_ = true;
        return is_of_process(action) ? Meeting{false, false, gone()} : Meeting{};
      }
      default:
        break;
    }
    const bool once = fault == Fault::Late || fault == Fault::Lost;
    const int snapshots = fault == Fault::Slow ? 0 : once ? 1 : std::numeric_limits<int>::max();
    const Lock lock(mutex_);
    hanging_.push_back({action, place, snapshots, fault == Fault::Slow || fault == Fault::Late});
    return {false, false, overdue()};
  }

  Meeting die(const model::Action& action, const std::optional<model::DeploymentKey>& place) {
    if (!place || place->is_runtime() || action.kind == model::ActionKind::Deploy) {
      return {false, false, broken()};  // who was only being started; the runtime's own ends the test too
    }
    model::Deployment dead;
    dead.host = place->host;
    dead.process = place->process;
    const model::Action kill{0, model::ActionKind::Undeploy, model::DeploymentAction{dead, true}, {}, {}};
    const bool was_there = inner_.perform(kill, patience()).has_value();
    Listener notify;
    {
      const Lock lock(mutex_);
      notify = listener_;
    }
    if (was_there && notify) notify(task_host::ProcessEvent{*place, "was ended by SIGKILL", true});
    const bool is_told_so = action.kind == model::ActionKind::Undeploy;
    return is_told_so ? Meeting{} : Meeting{false, false, gone()};
  }

  // With the lock held.
  bool strikes(const model::Action& action) const {
    if (!fault_ || action.label() != label_) return false;
    return !struck_ || *fault_ == Fault::Persistent || *fault_ == Fault::DiesAgain;
  }
  /// Whether another action of the same task hangs.
  bool is_held_up(const model::Action& action) const {
    const auto* id = action.task();
    return id != nullptr && std::any_of(hanging_.begin(), hanging_.end(), [&](const Hanging& one) {
             return one.action.task() != nullptr && *one.action.task() == *id;
           });
  }
  /// False where no action of the task hangs.
  bool forget_hanging(const model::TaskId& id) {
    const Lock lock(mutex_);
    return std::erase_if(hanging_, [&](const Hanging& one) {
             return one.action.task() != nullptr && *one.action.task() == id;
           }) > 0;
  }
  void take_down(model::ActionKind kind, const model::TaskId& id) {
    static_cast<void>(inner_.perform({0, kind, model::TaskAction{id}, {}, {}}, patience()));
  }
  /// Hanging actions end with their process.
  void end_hanging(model::Action& undeploy) {
    auto& what = std::get<model::DeploymentAction>(undeploy.what);
    const auto ended =
        std::erase_if(hanging_, [&](const Hanging& one) { return one.process == what.deployment.key(); });
    what.kill = what.kill || ended > 0;
  }

  /// The process of an action: that of its task, of the connection's reader, or else of its writer.
  [[nodiscard]] std::optional<model::DeploymentKey> place_of(const model::Action& action) const {
    if (const auto* process = std::get_if<model::DeploymentAction>(&action.what)) {
      return process->deployment.key();
    }
    if (const auto* config = std::get_if<model::ConfigAction>(&action.what)) return config->process;
    if (const auto* wire = std::get_if<model::ConnectionAction>(&action.what)) {
      const auto reader = process_of(wire->connection.to.task);
      return reader && !reader->is_runtime() ? reader : process_of(wire->connection.from.task);
    }
    return action.task() == nullptr ? std::nullopt : process_of(*action.task());
  }
  [[nodiscard]] std::optional<model::DeploymentKey> process_of(const model::TaskId& task) const {
    for (const auto& report : inner_.tasks()) {
      if (report.id == task) return report.process;
    }
    return std::nullopt;
  }

  mutable Mutex mutex_;
  std::optional<Fault> fault_;
  std::string label_;
  bool struck_ = false;
  std::optional<model::DeploymentKey> place_;
  bool server_is_down_ = false;
  mutable std::vector<Hanging> hanging_;
  std::vector<model::Action> passed_;
  Listener listener_;
};

}  // namespace segue::testing
