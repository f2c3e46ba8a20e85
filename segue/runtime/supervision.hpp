// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/solve/repair.hpp>

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// Detects failed parts of the running controller and decides when to repair them. Pure: no threads, no host.
namespace segue::runtime::detail {

/// A task or process that is not in the state that the controller requires.
struct DetectedFault {
  std::variant<model::TaskId, model::DeploymentKey> subject;
  model::FailurePolicy policy = model::FailurePolicy::Report;
  std::string symptom;            ///< "is in exception"
  bool needs_process = false;     ///< only a new process can repair it
  bool lacks_connection = false;  ///< it is a task that is well but for a connection that it reads

  [[nodiscard]] std::string name() const;  ///< "task 'slam'"
};

/// Tasks and processes of `wanted` that are missing in `observed` or in another state, and the readers of
/// missing connections. Each task is listed once; a missing process is listed instead of its tasks.
/// Properties are not compared, since users may set them. `otherwise` is the policy where the network names
/// none.
std::vector<DetectedFault> find_faults(const model::Network& wanted, const model::Network& observed,
                                       model::FailurePolicy otherwise);

/// The attempts to repair a fault so far.
struct Handling {
  int attempts = 0;
  bool given_up = false;
};

/// The policy when the limit on the number of attempts is reached.
enum class AfterLimit {
  GiveUp,  ///< it is reported, and nothing more is tried
  GoOn     ///< it is reported, and tried on at the longest interval at last
};

/// Schedules repair attempts with exponential back-off and a limit on their number. Not thread safe.
class RepairScheduler {
 public:
  RepairScheduler(model::RestartPolicy restart, AfterLimit after_limit)
      : restart_(restart), after_limit_(after_limit) {}

  struct Decision {
    std::vector<DetectedFault> repair;    ///< to be repaired now
    std::vector<DetectedFault> given_up;  ///< first time that the limit is reached
    bool fallback = false;                ///< to be switched to now
    [[nodiscard]] bool empty() const { return repair.empty() && given_up.empty() && !fallback; }
  };
  /// Takes all present faults. Each one that is returned in `repair` counts as an attempt.
  Decision decide(const std::vector<DetectedFault>& faults, TimePoint now);
  /// When the next attempt is due for a fault that decide() was given last; nothing if none is.
  [[nodiscard]] std::optional<TimePoint> next() const;
  /// The number of repair attempts for the fault's subject.
  [[nodiscard]] int attempts(const DetectedFault& fault) const;
  /// The present faults, as they were given to decide(), whose limit has been reached.
  [[nodiscard]] std::vector<DetectedFault> exhausted(const std::vector<DetectedFault>& faults) const;
  /// The handling of each of these faults so far, by the name of the fault.
  [[nodiscard]] std::map<std::string, Handling> handling(const std::vector<DetectedFault>& faults) const;
  /// Forgets all attempts: a new request has changed what runs.
  void reset() { cases_.clear(); }

 private:
  struct Case {
    int attempts = 0;
    TimePoint next;
    TimePoint last_seen;
    bool given_up = false;
  };

  [[nodiscard]] bool may_try(const Case& one) const {
    return !one.given_up || after_limit_ == AfterLimit::GoOn;
  }
  void forget_recovered(TimePoint now);
  void consider(const DetectedFault& fault, TimePoint now, Decision& decision);
  [[nodiscard]] Duration backoff(int attempts) const;

  const model::RestartPolicy restart_;
  const AfterLimit after_limit_;
  std::map<std::string, Case> cases_;  ///< by name
  TimePoint decided_;                  ///< when decide() was called last
};

/// All of them are to be repaired.
solve::RepairScope scope_of(const std::vector<DetectedFault>& faults);
/// Of one that was given up: what it is, and how many attempts have not helped.
std::string sentence_of(const DetectedFault& fault, const RepairScheduler& scheduler);

}  // namespace segue::runtime::detail
