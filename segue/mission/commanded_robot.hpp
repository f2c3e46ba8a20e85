// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/question.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/mission/controller_use.hpp>
#include <segue/model/taken_instance.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// A task of the robot as the robot reports it.
struct TaskView {
  std::string state;       ///< "running", "stopped", ...
  std::string state_name;  ///< one that its component declares ("arrived"); may be empty
  std::uint64_t updates = 0;
  std::uint64_t changes = 0;  ///< the count of CommandedRobot::changes() after that was seen; 0: not known
  friend bool operator==(const TaskView&, const TaskView&) = default;
};

/// A question for the level of a task, from a caller that waits for changes.
struct TaskQuestion {
  std::string task;
  std::optional<TaskView> seen{};  ///< what whoever asks knows; nothing: the answer comes at once
  bool each_update = false;        ///< another count of updates is a change, too

  [[nodiscard]] bool is_news(const TaskView& view) const {
    return !seen || view.state != seen->state || view.state_name != seen->state_name ||
           (each_update && view.updates != seen->updates);
  }
};
/// Gets the answer, once, from any thread, also before the function that asks returns. Must not block.
using TaskAnswer = std::function<void(Result<TaskView>)>;

/// Gets a count of changes, as TaskAnswer.
using ChangesAnswer = std::function<void(Result<std::uint64_t>)>;

/// Gets samples, oldest first, once, from any thread, also before the function that asks returns. Must not
/// block.
using SamplesAnswer = std::function<void(Result<std::vector<type::Value>>)>;

/// Samples of a port, for one reader.
class PortSamples {
 public:
  virtual ~PortSamples() = default;
  /// The samples that came since the last call, oldest first. Waits for the robot, but for no sample.
  virtual Result<std::vector<type::Value>> take(const Wait& wait) = 0;
  /// Takes samples like take(), but answers as soon as there is one; with none at the end of the wait. Does
  /// not block.
  virtual void next(const Wait& wait, SamplesAnswer answered) = 0;
};

/// A request for a network: the union of these controllers, with these properties in place of theirs.
struct ControllerRequest {
  std::vector<std::string> controllers;  ///< none: the empty network
  std::vector<MemberValue> properties;

  /// An action that asks for this.
  struct Cause {
    std::string action;  ///< its path: "fetch/grasp"; empty: the mission is that action
    std::uint64_t iteration = 0;
    std::string controller{};  ///< that it needs; empty: one of its controllers is to be stopped
    friend bool operator==(const Cause&, const Cause&) = default;
  };
  std::vector<Cause> causes{};
};

/// Which of a robot's controllers cannot run at once, and what both need.
struct ControllerConflicts {
  /// Two controllers, by name, that both need `what`.
  struct Pair {
    std::string a;
    std::string b;
    std::string what;  ///< "task arm", "device wheels"
    friend bool operator==(const Pair&, const Pair&) = default;
  };
  std::vector<std::string> controllers;  ///< all that the robot has
  std::vector<Pair> pairs;
  /// `a` can run beside `b`, but writes to inputs of its tasks that `b` alone leaves alone.
  std::vector<Pair> influences{};
  [[nodiscard]] bool conflict(std::string_view a, std::string_view b) const;
  [[nodiscard]] bool influence(std::string_view a, std::string_view b) const;
};

/// The reason why the robot does not run a controller as it should; `why` is empty: it does, except for the
/// tasks.
struct ControllerTrouble {
  std::string why;
  /// A task that is in trouble.
  struct Task {
    std::string id;
    std::string why;
  };
  std::vector<Task> tasks{};  ///< that are broken, and will not be mended
  std::string repair{};       ///< what of it is being mended; empty: nothing
  [[nodiscard]] bool runs_well() const { return why.empty() && tasks.empty() && repair.empty(); }
};

/// An instance of a pool of processes.
struct PoolInstanceView {
  std::string task;
  int pid = 0;            ///< tells one life of its process from the next
  bool ready = false;     ///< its operations can be called
  bool given_up = false;  ///< it is not likely to become ready again
  std::string reason{};   ///< why it is not ready
  bool busy = false;      ///< an operation is carried out, for whomever
};
/// A pool of the robot, as missions see it.
struct PoolView {
  std::string name;
  std::vector<PoolInstanceView> instances;  ///< that there are now
  std::uint32_t most = 0;                   ///< how many there are where as many calls wait
};

/// The robot as missions command it: it runs in this process or in another one, or is simulated. Functions
/// may be called from any thread; they block until the robot has answered, as long as their Wait says where
/// they have one. Whoever is stopped while it waits commands nothing afterwards, and gets Cancelled at once.
class CommandedRobot {
 public:
  virtual ~CommandedRobot() = default;

  /// Makes the robot run that network by one transition. Returns once it runs; the error says why it does
  /// not, and then the robot runs the same network as before. The first request takes the robot's lease,
  /// which ends with this: meanwhile it refuses requests of others unless they take it over. InvalidState
  /// then, for good, which says who has it. Where the wait is stopped, a transition that is not past its
  /// commit is undone, which is not waited for.
  virtual Result<void> request(const ControllerRequest& what, const Wait& wait) = 0;
  /// Whether the robot runs that controller, alone or beside others, without faults that could not be
  /// repaired.
  virtual Result<ControllerTrouble> trouble(std::string_view controller, const Wait& wait) = 0;
  /// Why the mission commands the robot no longer, as a sentence; nothing: it does. Waits for the robot,
  /// until a stop is requested, which is Cancelled.
  virtual Result<std::optional<std::string>> lost_command(const std::stop_token& /*stop*/) {
    return std::optional<std::string>();
  }
  /// The conflicts between all controllers of the robot.
  virtual Result<ControllerConflicts> conflicts(const Wait& wait) = 0;
  /// The robot's pools of processes.
  virtual Result<std::vector<PoolView>> pools(const Wait& /*wait*/) { return std::vector<PoolView>{}; }
  /// Has `answered` called with an instance of the pool that is ready and works for nobody: it is the
  /// caller's for its next call(), which must come within seconds. Until there is one, the caller waits, and
  /// the robot makes further instances for those who wait, as far as it may. Unavailable where none is likely
  /// to come; DeadlineExceeded at the deadline. Returns at once.
  virtual void take_instance(const model::InstanceQuestion& what, const Wait& /*wait*/,
                             model::InstanceAnswer answered) {
    answered(fail(ErrorCode::NotFound, "the robot has no pool " + what.pool));
  }
  /// Keeps these prepared beside what runs, the likeliest first, in place of those named before, as far as
  /// the robot's budget permits. Returns when that is done; a request comes first.
  virtual Result<void> prepare(const std::vector<std::string>& controllers, const Wait& wait) = 0;
  virtual Result<type::Value> call(const Member& operation, const type::Value& arguments,
                                   const Wait& wait) = 0;
  /// Sets a property of a task that is live, until the next transition configures the task.
  virtual Result<void> set(const Member& property, const type::Value& value, const Wait& wait) = 0;
  /// Writes a sample to an input port of a task that runs; returns once that has taken it.
  virtual Result<void> write(const Member& port, const type::Value& value, const Wait& wait) = 0;
  /// Has `answered` called with how the task is, once that is not as `question.seen` says; or, at the
  /// deadline, as it is then. Returns at once.
  virtual void watch(const TaskQuestion& question, const Wait& wait, TaskAnswer answered) = 0;
  /// Counts, from 1 on, whatever may change the answer of trouble(). Has `answered` called with the count
  /// when it is not `seen`; at the deadline as it is then. Returns at once.
  virtual void changes(std::uint64_t seen, const Wait& wait, ChangesAnswer answered) = 0;
  /// How the task is now.
  Result<TaskView> task(const std::string& id, const Wait& wait) {
    return answer_to<TaskView>(
        wait, [&](const Wait& both, TaskAnswer answer) { watch({id}, both, std::move(answer)); });
  }
  /// The latest samples of an output port from now on.
  virtual Result<std::unique_ptr<PortSamples>> open(const Member& port, const Wait& wait) = 0;
};

}  // namespace segue::mission
