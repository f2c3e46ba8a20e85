// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/control/robot_lease.hpp>
#include <segue/control/robot_request.hpp>
#include <segue/model/taken_instance.hpp>
#include <segue/runtime/controller_conflict.hpp>
#include <segue/runtime/runtime.hpp>

#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime {

/// A Runtime as servers offer it to others, who share the robot: leases, reports of missions, and whatever a
/// client compares or waits for. Part of its Runtime. All functions may be called from any thread and do not
/// block unless stated.
class ServedRuntime {
 public:
  explicit ServedRuntime(Runtime::Implementation& implementation) : implementation_(implementation) {}
  ServedRuntime(const ServedRuntime&) = delete;
  ServedRuntime& operator=(const ServedRuntime&) = delete;

  /// The right to request controllers and to apply files, for one holder at a time, until end_lease(), or
  /// until somebody takes the robot over. InvalidState while another one holds it. What the runtime does by
  /// itself (repair, fallback) needs none. The result is a secret of the holder, which nothing else shows.
  Result<std::uint64_t> take_lease(std::string holder);
  /// Unless it is to `keep` running what it runs, or that is nothing, a robot that says what rest is
  /// (ControllerSet::halt) halts: the result; otherwise no future. Open requests of that lease are cancelled.
  std::shared_future<HaltResult> end_lease(std::uint64_t lease, bool keep = false);
  [[nodiscard]] control::LeaseStanding lease_standing(std::uint64_t lease) const;
  /// Why nothing is done with that lease any more; nothing for 0, which is none.
  [[nodiscard]] std::optional<Error> lease_refusal(std::uint64_t lease) const;
  [[nodiscard]] std::optional<std::string> lease_holder() const;
  /// Whether something other than a request may be done with tasks: by the holder of the lease, by anybody
  /// where there is none, and by others beside what the holder is doing, which is an event: "ann sets
  /// 'wheels.speed'". InvalidState. Nothing is changed by this.
  Result<void> allow(const Sender& sender, const std::string& what);

  /// Records what the holder of that lease is doing, for status; InvalidState where it has lost the lease. A
  /// holder that is stopped, and has said that it has nothing to do then, commands nothing any more, and the
  /// robot halts at once. What it says of the robot's units is on the disk when this returns: only then it
  /// blocks.
  Result<void> report(std::uint64_t lease, type::Value doing);
  [[nodiscard]] type::Value reported() const;  ///< null: nothing
  /// As of control::RobotService::mission.
  [[nodiscard]] type::Value mission(std::uint64_t after, bool with_plan);
  /// As of control::RobotService::send_command. The holder takes it by take_commands(); "stop": see report().
  Result<std::uint64_t> send_command(std::string_view what, const type::Value& arguments = {});
  [[nodiscard]] std::vector<control::HolderRequest> take_commands(std::uint64_t lease);

  /// As of control::RobotService::units. Blocks.
  [[nodiscard]] Result<type::Value> units() const;
  /// Sets one of them, which is an event, and returns how many there were. Blocks. NotFound; InvalidState
  /// while somebody commands the robot, who goes by the counts that there were when that began.
  Result<std::uint32_t> set_units(std::string_view name, std::uint32_t count, const std::string& who);

  /// As Runtime::prepare(), for the holder of that lease: the controllers are kept until it ends.
  std::future<std::vector<Readiness>> prepare(std::vector<model::NetworkName> controllers,
                                              std::uint64_t lease);
  /// The controllers that Runtime::load() would replace, with the problems of networks that cannot run here.
  std::vector<ControllerChange> compare(const ControllerSet& set, Diagnostics& diagnostics) const;
  /// For each two of these controllers what keeps them from running at once, and influences. NotFound.
  [[nodiscard]] Result<std::vector<ControllerConflict>> conflicts(
      const std::vector<model::NetworkName>& controllers) const;

  /// As control::RobotService::take_instance().
  void take_instance(const model::InstanceQuestion& what, const Wait& wait, model::InstanceAnswer answered);

  /// The result of a halt on its way; no future: there is none.
  [[nodiscard]] std::shared_future<HaltResult> halt_on_its_way() const;
  /// Processes of the running controller that have ended and are missing: why, and the end of their logs.
  [[nodiscard]] std::map<model::DeploymentKey, std::string> ended_processes() const;
  /// Counts, from 1 on, what may change the name of Runtime::belief(), unresolved(), in_repair(), or
  /// lease_standing().
  [[nodiscard]] std::uint64_t changes() const;
  /// `answered` gets that count, once, from any thread, when it is not `seen`, or at the deadline.
  void watch_changes(std::uint64_t seen, const Wait& wait,
                     std::function<void(Result<std::uint64_t>)> answered) const;
  /// Blocks until the journal's file has everything so far. DeadlineExceeded, or what keeps it from that.
  [[nodiscard]] Result<void> flush_journal(Deadline deadline) const;

 private:
  Runtime::Implementation& implementation_;
};

}  // namespace segue::runtime
