// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/control/robot_lease.hpp>
#include <segue/control/robot_request.hpp>
#include <segue/control/sample_stream.hpp>
#include <segue/model/taken_instance.hpp>
#include <segue/task_host/task_level.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// How other processes reach a running robot: Cap'n Proto over a Unix socket.
namespace segue::control {

/// How a task is, and the count of RobotService::changes() after that was seen. Where the count has not moved
/// since running() was asked, what that has answered held at that moment, too.
struct RobotLevel {
  task_host::TaskLevel level;
  std::uint64_t changes = 0;  ///< 0: an earlier version, which does not say
};
/// Gets the level, once, from any thread, also before the function that asks returns. Must not block.
using RobotLevelAnswer = std::function<void(Result<RobotLevel>)>;

/// Gets the count, as RobotLevelAnswer.
using ChangesAnswer = std::function<void(Result<std::uint64_t>)>;

/// The interface of a running robot, the same on both sides: the runtime implements it, the server carries it
/// over a socket, and Client offers it in another process. Answers are Values with the fields of formats.md.
/// Functions may be called from any thread; those with a deadline block until then at the most. Where a Wait
/// is stopped, a call that has not begun does not begin any more; of those that have, only a request for a
/// controller is given up, as by cancel(). Calls that only look take 10 s at most, with any Wait.
class RobotService {
 public:
  virtual ~RobotService() = default;

  /// {"robot", "file" (the robot file; null: none), "controller", "version", "loaded_version",
  /// "changed_files", "state", "controllers", "transitions", "requests" (not ended: {"request", "to", "who",
  /// "state" ("waiting", "planning", "prepare", "commit", "retire", "undo"), "cancelled_by"}), "pools",
  /// "pid", "uptime_s", "tasks", "connections", "differences", "commanded_by", "lost", "doing", "halt" (null,
  /// or {"who", "why", "time_s" (since 1970), "state" ("halting", "at_rest", "not_at_rest"), "stopped",
  /// "trouble"}), "stopped_by" (until release_stop(); null: nobody), "health" ({"state" ("healthy",
  /// "in_transition", "in_trouble", "lost"), "troubles": [{"kind" ("robot", "host", "process", "task",
  /// "connection", "pool"), "name", "what", "why", "since", "for_s", "repair", "on_request"}]})}
  virtual Result<type::Value> status(const Wait& wait) = 0;
  Result<type::Value> status() { return status(Wait(TimePoint::max())); }
  /// {"id", "component", "state", ..., "ports", "properties", "operations", "timing", "histograms", "log"}
  virtual Result<type::Value> task(std::string_view id, const Wait& wait) = 0;
  Result<type::Value> task(std::string_view id) { return task(id, Wait(TimePoint::max())); }
  /// Has `answered` called once the task's level is not as the caller has seen it; see
  /// task_host::TaskHost::watch().
  virtual void watch(const task_host::LevelQuestion& question, const Wait& wait,
                     RobotLevelAnswer answered) = 0;
  /// {"controller", "unresolved"} of status(), and like the latter "in_repair", faults that are being mended,
  /// or will be; no process is asked. Where `lease` is not 0, also the standing() of that lease, which is
  /// looked at last: "lost_to" (null: its holder commands the robot), "stopped".
  virtual Result<type::Value> running(std::uint64_t lease, const Wait& wait) = 0;
  /// Counts, from 1 on, whatever may change the answer of running(). Has `answered` called with the count
  /// when it is not `seen`; at the deadline as it is then. Returns at once.
  virtual void changes(std::uint64_t seen, const Wait& wait, ChangesAnswer answered) = 0;
  /// Requests a controller ("arm+drive": several at once); answers the JSON of `switch` when it is done.
  virtual Result<type::Value> switch_to(std::string_view controller, const RequestOptions& options,
                                        const Wait& wait) = 0;
  /// The transition that switch_to() would execute now: the JSON of `diff`.
  virtual Result<type::Value> diff(std::string_view controller, const RequestOptions& options,
                                   const Wait& wait) = 0;
  /// Requests a network that is none of the robot's controllers: the text of a network file, of 4 MiB at
  /// most; `file` for messages. Answers as switch_to(). AlreadyExists where the robot has another controller
  /// of its name.
  virtual Result<type::Value> switch_to_network(std::string_view text, std::string_view file,
                                                const RequestOptions& options, TimePoint deadline) = 0;
  /// The transition that switch_to_network() would execute now: the JSON of `diff`.
  virtual Result<type::Value> diff_to_network(std::string_view text, std::string_view file,
                                              const RequestOptions& options, TimePoint deadline) = 0;
  /// The changes that apply() would make with the robot's files as they are now: {"outcome" ("done", or
  /// "refused" where the files have errors), "controller", "from_version", "to_version", "changes",
  /// "diagnostics", and if there is one "transition" (as of `diff`)}. The transition leads to `controller`,
  /// or where that is empty to the new version of the controller that runs. Unsupported where the runtime has
  /// no files. Of the options only order and force count.
  virtual Result<type::Value> plan(std::string_view controller, const RequestOptions& options,
                                   TimePoint deadline) = 0;
  /// Takes the robot's files as they are now, and then the controller that runs to its new version; answers
  /// when both are done: {"outcome", "changes", "diagnostics", "transition" (as of `switch`), "error"}.
  virtual Result<type::Value> apply(const RequestOptions& options, TimePoint deadline) = 0;
  virtual Result<type::Value> repair(const RequestOptions& options,
                                     const Wait& wait) = 0;  ///< as switch_to()
  /// Sets which controllers are kept ready, the likeliest first, in place of those set before; with a lease,
  /// until that ends (InvalidState where it has). Returns when it is done: a list of {"controller", "ready",
  /// "prepared", "tasks", "reason"}.
  virtual Result<type::Value> prepare(const std::vector<std::string>& controllers, std::uint64_t lease,
                                      const Wait& wait) = 0;
  /// The reasons why two of these controllers (none: of all that the robot has) cannot run at once: a list of
  /// {"a", "b", "what", "reason", "influence"}; where "influence" is true they can, but "a" changes what
  /// tasks of "b" get.
  virtual Result<type::Value> conflicts(const std::vector<std::string>& controllers, const Wait& wait) = 0;
  Result<type::Value> conflicts(const std::vector<std::string>& controllers) {
    return conflicts(controllers, Wait(TimePoint::max()));
  }
  /// Takes the robot's lease; InvalidState while somebody else holds it. `holder` is named to whoever is
  /// refused.
  virtual Result<std::unique_ptr<RobotLease>> lease(std::string_view holder) = 0;
  /// Reports the work of the holder of that lease, for status(). InvalidState where it is not held any more.
  /// A mission says {"mission", "state", "running", "ended", "control", "at_end" ("keep": however its lease
  /// ends, the robot runs on), "at_stop" ("halt": it has nothing to do when it is stopped, so the robot comes
  /// to rest at once, and nothing is commanded with that lease any more, when it is asked to stop or says
  /// that its state is "stopping")}, and in "happened" what the robot's journal shall have: {"sent_ns" (the
  /// sender's time since 1970), "lost" (entries so far that it could not keep), "entries": a list of
  /// {"number" (from 1, rising), "time_ns", "kind" ("began", "asked", "ended"), "action" (none: the mission),
  /// "iteration", "controller", "outcome", "error", "duration_ns", "mode" (of the mission)}}. In "units",
  /// what becomes of the robot's units: {"run", "begun" (the counts by name when that run began; InvalidState
  /// where others have changed one since), "changes": a list of {"execution", "units" (changes by name)}};
  /// each execution of a run counts once. A report of units only leaves the rest as it was reported before.
  virtual Result<void> report(std::uint64_t lease, const type::Value& doing) = 0;
  /// The mission that commands the robot, or the last one that did; null where none has since the runtime
  /// began: {"run" (counts missions), "mission", "who", "state" ("running", "paused", "stopping", "ended"),
  /// "outcome" and "error" of what has ended ("lost": it did not say how), "entries": what happened after
  /// entry `after`, oldest first, 2000 at most, each {"number" (rising, over all missions), "time_s" (since
  /// 1970), "kind" ("began", "asked", "ended"), "action" ("": the mission), "iteration", "controller",
  /// "outcome", "error", "duration_s"}, "dropped": entries that are not kept any more}. `with_plan`: also
  /// "plan", of draw::shown_plan, null until the mission has told it; with "outline": true until it has told
  /// the whole, for which it is asked. "control", null where it has ended or does not say: {"steps" (it can
  /// be stepped), "back" (and stepped back), "at" (null, or the states before which it is held and at rest),
  /// "breakpoints", "heard" (the number of the last request of send_command() that it has followed or
  /// refused), "problem" ({"number", "text"}: why it refused that one; none: it refused none), "values"
  /// ({"number", "of"} and what mission::Engine::values_of has; none: it was not asked)}.
  virtual Result<type::Value> mission(std::uint64_t after, bool with_plan) = 0;
  /// Asks whoever holds the lease to "pause", "resume" or "stop" what it does; or a mission to "step"
  /// ({"how": "into", "over", "out" or "back"}), to have these breakpoints ("break", {"at": paths}), to
  /// "go_on_at" ({"at": path}), or for "values" ({"of": path}). It may take its time: the result is in
  /// "control" of mission(), under the number that is the answer. NotFound where nobody holds it,
  /// ResourceExhausted where it does not take requests.
  virtual Result<std::uint64_t> send_command(std::string_view what, const type::Value& arguments) = 0;
  /// Ends the command of the lease's holder. Unless the robot is to `keep` running its controller, a robot
  /// with a configured halt comes to rest: {"at_rest", "duration_s", "stopped" (tasks with devices that had
  /// to be stopped), "trouble" (why)} once it has, else null. A lease that ends without this halts it, too.
  virtual Result<type::Value> give_back(std::uint64_t lease, bool keep, TimePoint deadline) = 0;
  /// Brings the robot to rest, whoever commands it, and has it refuse whatever is requested until
  /// release_stop(). Answers as give_back(), once it is at rest or its devices are stopped.
  virtual Result<type::Value> stop(std::string_view who, TimePoint deadline) = 0;
  /// InvalidState where nobody has stopped it.
  virtual Result<void> release_stop(std::string_view who) = 0;
  /// Cancels a request ("requests" of status(); 0: the newest): one that waits ends, the transition of
  /// another one is undone if it is not past its point of commit. Answers the JSON of `switch` of the request
  /// when that is done. NotFound where no such request is open, InvalidState where it goes on. `who` for the
  /// journal.
  virtual Result<type::Value> cancel(std::uint64_t request, std::string_view who, TimePoint deadline) = 0;
  /// Applies a given transition, each action of which is checked before the first one is executed; answers as
  /// switch_to(). NotFound where the robot has none of that name. Order, force and properties do not count.
  virtual Result<type::Value> apply_transition(const GivenTransition& transition,
                                               const RequestOptions& options, TimePoint deadline) = 0;
  /// Expects this network to run from now on (the text of a network file, `file` for messages),
  /// or where the text is empty, what is observed now. ParseError where the network has errors.
  virtual Result<void> reset_belief(std::string_view network, std::string_view file) = 0;
  /// The units that the robot keeps (model::Robot::units), by name: a list of {"name", "count"}.
  virtual Result<type::Value> units() = 0;
  /// Corrects how many of them there are, and answers how many there were. NotFound; InvalidState while
  /// somebody commands the robot. `who` for the events.
  virtual Result<std::uint32_t> set_units(std::string_view name, std::uint32_t count,
                                          std::string_view who) = 0;
  virtual Result<void> set_property(std::string_view task, std::string_view property,
                                    const type::Value& value, const Sender& sender, const Wait& wait) = 0;
  virtual Result<type::Value> call(std::string_view task, std::string_view operation,
                                   const type::Value& arguments, const Sender& sender, const Wait& wait) = 0;
  /// Has `answered` called with an instance of a pool that is ready and works for nobody: it is the caller's
  /// for its next call(), which must come within 5 s. Until there is one, the caller waits, and the robot
  /// makes further instances for those who wait, as far as the pool's size and the budget permit. Unavailable
  /// where none has been ready for half a minute, or none is likely to come; DeadlineExceeded at the end of
  /// the wait. Returns at once.
  virtual void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                             model::InstanceAnswer answered) = 0;
  /// Writes a sample to an input port of a task that runs, and waits until that has taken it.
  virtual Result<void> write(std::string_view task, std::string_view port, const type::Value& value,
                             const Sender& sender, const Wait& wait) = 0;
  virtual Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                          std::size_t buffer, const Wait& wait) = 0;
  Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                  std::size_t buffer) {
    return open_port(task, port, buffer, Wait(TimePoint::max()));
  }
  /// A list of {"number", "time", "kind", "subject", "message"}; empty where none has come by the deadline.
  virtual Result<type::Value> events(std::uint64_t after, const Wait& wait) = 0;
  /// A list of the JSON of `switch`, oldest first.
  virtual Result<type::Value> history() = 0;
  /// Answers about the past from the robot's journal, of bounded size, as journal::answer_about_past() does.
  /// Everything that happened before the call is in the journal's file then, if that can be written.
  /// Unsupported where none is kept.
  virtual Result<type::Value> past(const type::Value& question) = 0;
  /// Asks the runtime to bring the robot to the empty network and end.
  virtual Result<void> shut_down() = 0;
};

}  // namespace segue::control
