// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/health_view.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>
#include <variant>

namespace segue::runtime::detail {

namespace {

constexpr std::string_view kTriesAgain = "`segue repair` tries again";

/// Without what introduces further lines, such as those of a log.
std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  const auto clause = line.rfind("; ");
  if (line.ends_with(':') && clause != std::string::npos) line.resize(clause);
  return line;
}

std::string attempts_text(int attempts) {
  return counted(static_cast<std::size_t>(attempts), "attempt") + (attempts == 1 ? " has" : " have") +
         " not helped";
}

/// The errors of tasks that have failed: the first of each id and of each process.
class FailedTasks {
 public:
  explicit FailedTasks(const std::vector<task_host::TaskReport>& reports) {
    for (const task_host::TaskReport& one : reports) {
      if (one.error.empty()) continue;
      by_task_.try_emplace(one.id, &one.error);
      by_process_.try_emplace(one.process, &one.error);
    }
  }

  /// Empty: nothing is said of it.
  [[nodiscard]] std::string error_of(const std::variant<model::TaskId, model::DeploymentKey>& subject) const {
    const auto* task = std::get_if<model::TaskId>(&subject);
    return task != nullptr ? find(by_task_, *task)
                           : find(by_process_, std::get<model::DeploymentKey>(subject));
  }

 private:
  template <class Errors, class Key>
  static std::string find(const Errors& errors, const Key& key) {
    const auto found = errors.find(key);
    return found == errors.end() ? std::string() : *found->second;
  }

  std::map<model::TaskId, const std::string*> by_task_;
  std::map<model::DeploymentKey, const std::string*> by_process_;
};

/// The error that the host reports of the task or process that is at fault.
std::string why_at_fault(const DetectedFault& fault, const HealthView& view, const FailedTasks& failed) {
  if (const auto* process = std::get_if<model::DeploymentKey>(&fault.subject)) {
    const auto found = view.ended.find(*process);
    if (found != view.ended.end()) return first_line(found->second);
  }
  return first_line(failed.error_of(fault.subject));
}

void say_what_repairs(Trouble& trouble, const DetectedFault& fault, const HealthView& view) {
  const auto found = view.handled.find(fault.name());
  const Handling handling = found == view.handled.end() ? Handling{} : found->second;
  if (fault.policy == model::FailurePolicy::Report) {
    trouble.repair = "`segue repair` repairs it; it is left so, as its 'on_failure' says";
    trouble.on_request = true;
  } else if (fault.policy == model::FailurePolicy::Fallback && view.fallback) {
    trouble.repair = "the robot goes to its fallback " + quote(view.fallback->str());
  } else if (handling.given_up) {
    trouble.repair = std::string(kTriesAgain) +
                     (handling.attempts == 0 ? "; only a new process would help, which its policy excludes"
                                             : "; " + attempts_text(handling.attempts));
    trouble.on_request = true;
  } else {
    trouble.repair = "the runtime repairs it by itself";
    if (handling.attempts > 0) trouble.repair += "; " + attempts_text(handling.attempts) + " so far";
  }
}

Trouble trouble_of(const DetectedFault& fault, const HealthView& view, const FailedTasks& failed) {
  Trouble trouble;
  if (const auto* task = std::get_if<model::TaskId>(&fault.subject)) {
    trouble.kind = fault.lacks_connection ? Trouble::Kind::Connection : Trouble::Kind::Task;
    trouble.name = task->str();
  } else {
    trouble.kind = Trouble::Kind::Process;
    trouble.name = to_string(std::get<model::DeploymentKey>(fault.subject));
  }
  trouble.what = fault.name() + ' ' + fault.symptom;
  trouble.why = why_at_fault(fault, view, failed);
  if (trouble.why.find(fault.symptom) != std::string::npos) trouble.why.clear();  // it says no more
  say_what_repairs(trouble, fault, view);
  return trouble;
}

std::optional<Trouble> trouble_of(const PoolReport& pool) {
  Trouble trouble{.kind = Trouble::Kind::Pool, .name = pool.pool, .what = {}};
  std::size_t ready = 0;
  std::vector<std::string> reasons;
  for (const PoolInstance& one : pool.instances) {
    ready += one.ready ? 1 : 0;
    trouble.on_request = trouble.on_request || one.given_up;
    if (!one.ready) reasons.push_back(one.task.str() + ": " + first_line(one.reason));
  }
  if (ready == pool.instances.size()) return std::nullopt;
  trouble.what = "pool " + quote(pool.pool) + " is short: " + std::to_string(ready) + " of " +
                 std::to_string(pool.instances.size()) + " ready";
  trouble.why = listed(reasons);
  trouble.repair =
      trouble.on_request ? std::string(kTriesAgain) : "the runtime starts what is missing by itself";
  return trouble;
}

std::optional<Trouble> trouble_of(const task_host::ComputerReport& computer) {
  if (computer.reachable || computer.optional) return std::nullopt;
  Trouble trouble{.kind = Trouble::Kind::Host, .name = computer.name.str(), .what = {}};
  trouble.what = "host " + quote(computer.name.str()) + " cannot be reached";
  trouble.why = first_line(computer.state);
  trouble.repair = "once it is back, the runtime brings it to what it should run";
  trouble.since = std::chrono::system_clock::now() -
                  std::chrono::duration_cast<std::chrono::system_clock::duration>(computer.since);
  return trouble;
}

Trouble loss_trouble(const std::string& why) {
  return {.kind = Trouble::Kind::Robot,
          .name = {},
          .what = "the robot is lost: another runtime commands it",
          .why = first_line(why),
          .repair = "only `segue run --take-over` gets it back"};
}

Trouble failure_trouble(const std::string& why) {
  return {.kind = Trouble::Kind::Robot,
          .name = {},
          .what = "a transition has failed and could not be undone, so what runs is not what was requested",
          .why = first_line(why),
          .repair = "`segue switch` to a controller"};
}

}  // namespace

Health health_of(const HealthView& view) {
  Health health;
  if (view.lost) {
    return {Health::State::Lost, {loss_trouble(*view.lost)}};
  }
  if (view.last_failure) health.troubles.push_back(failure_trouble(*view.last_failure));
  for (const auto& computer : view.computers) {
    if (auto trouble = trouble_of(computer)) health.troubles.push_back(std::move(*trouble));
  }
  const FailedTasks failed(view.tasks);
  for (const DetectedFault& fault : view.faults)
    health.troubles.push_back(trouble_of(fault, view, failed));
  for (const PoolReport& pool : view.pools) {
    if (auto trouble = trouble_of(pool)) health.troubles.push_back(std::move(*trouble));
  }
  health.state = view.in_transition        ? Health::State::InTransition
                 : health.troubles.empty() ? Health::State::Healthy
                                           : Health::State::InTrouble;
  return health;
}

void TroubleTimes::note(std::vector<Trouble>& troubles, std::chrono::system_clock::time_point now) {
  const Lock lock(mutex_);
  std::map<std::string, std::chrono::system_clock::time_point> present;
  for (Trouble& trouble : troubles) {
    if (trouble.kind == Trouble::Kind::Host) continue;
    const std::string key = std::to_string(static_cast<int>(trouble.kind)) + ' ' + trouble.name;
    const auto known = since_.find(key);
    trouble.since = present.emplace(key, known == since_.end() ? now : known->second).first->second;
  }
  since_ = std::move(present);
}

}  // namespace segue::runtime::detail
