// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/runtime/health.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/supervision.hpp>
#include <segue/task_host/reports.hpp>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// How the health of a robot follows from what its runtime has seen.
namespace segue::runtime {

namespace detail {

/// From what the health of a robot follows. Refers to values that outlive it.
struct HealthView {
  bool in_transition = false;
  std::optional<std::string> lost{};          ///< why
  std::optional<std::string> last_failure{};  ///< of a transition that could not be undone
  std::optional<model::NetworkName> fallback{};
  const std::vector<DetectedFault>& faults;
  const std::map<std::string, Handling>& handled;  ///< by name of the fault
  const std::map<model::DeploymentKey, std::string>& ended;
  const std::vector<task_host::TaskReport>& tasks;
  const std::vector<task_host::ComputerReport>& computers;
  const std::vector<PoolReport>& pools;
};

/// Without the times since when. Pure.
Health health_of(const HealthView& view);

/// Remembers since when parts have been in trouble. Thread safe.
class TroubleTimes {
 public:
  /// Fills in the times of `troubles`, which are all that there are now; those of hosts are known already.
  void note(std::vector<Trouble>& troubles, std::chrono::system_clock::time_point now);

 private:
  Mutex mutex_;
  /// By kind and name.
  std::map<std::string, std::chrono::system_clock::time_point> since_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace detail

}  // namespace segue::runtime
