// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/control/peer.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/files_verbs.hpp>
#include <segue/web/robot_link.hpp>

#include <functional>
#include <string>
#include <vector>

namespace segue::web {

using control::Role;

/// What pages can ask.
std::vector<std::string> verb_names();

/// Executes what pages ask a robot for, each in a thread of its own, so that a call that takes long delays
/// nobody. All functions may be called from any thread.
class Verbs {
 public:
  using Answer = std::function<void(Result<type::Value>)>;

  /// At once; what is beyond is refused with ResourceExhausted.
  static constexpr std::size_t kMostCalls = 12;

  explicit Verbs(RobotLink& link, ModelsOf models = {});
  /// Waits for the calls in progress, until their deadlines at most.
  ~Verbs() { pool_.close(); }
  Verbs(const Verbs&) = delete;
  Verbs& operator=(const Verbs&) = delete;

  /// Calls `answer` once, from another thread or from here. PermissionDenied where the role does not allow
  /// it. `who` asks, for the robot's journal.
  void begin(Command command, Role role, const std::string& who, Answer answer);

 private:
  Result<type::Value> execute(const Command& command, const std::string& who);

  RobotLink& link_;
  FileVerbs files_;
  concurrent::ThreadPool pool_{"segue-studio", {.threads = kMostCalls, .idle = 2}};
};

}  // namespace segue::web
