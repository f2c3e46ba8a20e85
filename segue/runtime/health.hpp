// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/supervision.hpp>
#include <segue/task_host/reports.hpp>

#include <array>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Whether a robot has all that it needs.
namespace segue::runtime {

/// Something that the robot needs and that is missing, faulty or given up.
struct Trouble {
  enum class Kind { Robot, Host, Process, Task, Connection, Pool };
  Kind kind = Kind::Robot;
  std::string name;         ///< of the part; of a connection its reader
  std::string what;         ///< a sentence without its full stop: "task 'slam' is in exception"
  std::string why{};        ///< empty: it is not known
  std::string repair{};     ///< what repairs it, or who
  bool on_request = false;  ///< Runtime::repair() repairs it, or tries to
  std::chrono::system_clock::time_point since{};
};
inline constexpr std::array<std::string_view, 6> kTroubleKindNames = {"robot", "host",       "process",
                                                                      "task",  "connection", "pool"};

struct Health {
  enum class State {
    Healthy,
    InTransition,  ///< whatever is missing may be about to come
    InTrouble,
    Lost  ///< another runtime commands the robot
  };
  State state = State::Healthy;
  std::vector<Trouble> troubles{};
};
inline constexpr std::array<std::string_view, 4> kHealthNames = {"healthy", "in_transition", "in_trouble",
                                                                 "lost"};

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
