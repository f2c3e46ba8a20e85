// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/control/verbs.hpp>
#include <segue/rpc/peer.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/files_verbs.hpp>
#include <segue/web/mission_starts.hpp>
#include <segue/web/robot_link.hpp>
#include <segue/web/ros2_looks.hpp>

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace segue::web {

using control::Role;

/// A verb as pages ask it.
struct VerbForm {
  std::string name;
  control::Verb verb = control::Verb::Status;  ///< says who may
  std::vector<std::string> arguments;          ///< their names; there are no others
};
/// The verbs that pages can ask for.
std::vector<VerbForm> verb_forms();

/// Executes what pages ask a robot for, each in a thread of its own, so that a call that takes long delays
/// nobody. All functions may be called from any thread.
class Verbs {
 public:
  using Answer = Ros2Looks::Answer;

  /// The most calls at once; further ones are refused with ResourceExhausted.
  static constexpr std::size_t kMostCalls = 12;
  /// The part of these for browsers that may only observe, so that they leave calls to those that operate.
  static constexpr std::size_t kMostCallsOfObservers = 8;
  /// Calls that stop the robot, beside the others: nothing keeps them waiting.
  static constexpr std::size_t kMostStops = 4;

  explicit Verbs(RobotLink& link, ModelsOf models = {}, RunMission run = {}, LookAtRos2 look = {});
  /// Waits for the calls in progress, until their deadlines at most.
  ~Verbs() {
    pool_.close();
    stops_.close();
  }
  Verbs(const Verbs&) = delete;
  Verbs& operator=(const Verbs&) = delete;

  /// Calls `answer` once, from another thread or from here. PermissionDenied where the role does not allow
  /// it. `who` asks, for the robot's journal.
  void begin(Command command, Role role, const std::string& who, Answer answer);

 private:
  Result<type::Value> execute(const Command& command, const PageUser& user);

  RobotLink& link_;
  FileVerbs files_;
  MissionStarts missions_;
  Ros2Looks looks_;
  std::atomic<std::size_t> calls_of_observers_{0};  ///< in progress; only a limit, which orders nothing
  concurrent::ThreadPool pool_{"segue-studio", {.threads = kMostCalls, .idle = 2}};
  concurrent::ThreadPool stops_{"segue-stops", {.threads = kMostStops, .idle = 1}};
};

}  // namespace segue::web
