// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// How other processes reach a running robot: Cap'n Proto over a Unix socket.
namespace segue::control {

/// Samples of an output port for a remote reader.
class SampleStream {
 public:
  virtual ~SampleStream() = default;
  virtual Result<std::vector<type::Value>> read(std::size_t limit) = 0;
  [[nodiscard]] virtual std::string type_name() const = 0;
};

/// Options of a request for a controller.
struct SwitchOptions {
  bool dry_run = false;  ///< only return the transition
  bool force = false;    ///< removed processes are killed, without any action in them before
  std::string order{};   ///< "seamless" or "paper"; empty: the robot's default
  std::string who{};     ///< who requests it, for the journal
};

/// What a running robot offers. The same interface on both sides: the runtime implements it, the server
/// carries it over a socket, and Client is it again in another process. Answers are Values with the fields of
/// formats.md. Functions may be called from any thread; those with a deadline block until then at the most.
class RobotService {
 public:
  virtual ~RobotService() = default;

  /// {"robot", "controller", "version", "loaded_version", "changed_files", "state", "controllers", "pid",
  /// "uptime_s", "tasks", "connections", "differences"}
  virtual Result<type::Value> status() = 0;
  /// {"id", "component", "state", ..., "ports", "properties", "operations", "timing"}
  virtual Result<type::Value> task(std::string_view id) = 0;
  /// Requests a controller; answers the JSON of `switch` when it is done. dry_run: the JSON of `diff`.
  virtual Result<type::Value> switch_to(std::string_view controller, const SwitchOptions& options,
                                        TimePoint deadline) = 0;
  /// Requests a network that is none of the robot's controllers: the text of a network file, of 4 MiB at
  /// most; `file` for messages. Answers as switch_to(). AlreadyExists where the robot has another controller
  /// of its name.
  virtual Result<type::Value> switch_to_network(std::string_view text, std::string_view file,
                                                const SwitchOptions& options, TimePoint deadline) = 0;
  /// What apply() would do with the robot's files as they are now: {"outcome" ("done", or "refused" where the
  /// files have errors), "controller", "from_version", "to_version", "changes", "diagnostics", and if there
  /// is one "transition" (as of `diff`)}. The transition leads to `controller`, or where that is empty to the
  /// new version of the controller that runs. Unsupported where the runtime has no files. dry_run and who do
  /// not count.
  virtual Result<type::Value> plan(std::string_view controller, const SwitchOptions& options,
                                   TimePoint deadline) = 0;
  /// Takes the robot's files as they are now, and then the controller that runs to its new version; answers
  /// when both are done: {"outcome", "changes", "diagnostics", "transition" (as of `switch`), "error"}.
  virtual Result<type::Value> apply(const SwitchOptions& options, TimePoint deadline) = 0;
  /// Sets which controllers are kept ready, the likeliest first, in place of those set before. Returns when
  /// it is done: a list of {"controller", "ready", "prepared", "tasks", "reason"}.
  virtual Result<type::Value> prepare(const std::vector<std::string>& controllers, TimePoint deadline) = 0;
  /// Applies a given transition (the text of a transition file, `file` for messages).
  virtual Result<type::Value> apply_transition(std::string_view text, std::string_view file,
                                               TimePoint deadline) = 0;
  virtual Result<void> reset_belief() = 0;
  virtual Result<void> set_property(std::string_view task, std::string_view property,
                                    const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(std::string_view task, std::string_view operation,
                                   const type::Value& arguments, TimePoint deadline) = 0;
  virtual Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                          std::size_t buffer) = 0;
  /// A list of {"number", "time", "kind", "subject", "message"}.
  virtual Result<type::Value> events(std::uint64_t after, Duration wait) = 0;
  /// A list of the JSON of `switch`, oldest first.
  virtual Result<type::Value> history() = 0;
  /// Asks the runtime to bring the robot to the empty network and end.
  virtual Result<void> shut_down() = 0;
};

}  // namespace segue::control
