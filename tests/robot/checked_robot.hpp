// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <support/forwarding_commanded_robot.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace segue::testing {

/// A robot that lets pass whatever a mission asks of another one, and compares what that answers with a model
/// of what it must then run. Thread safe.
class CheckedRobot final : public ForwardingCommandedRobot {
 public:
  /// `runtime` is that of `inner`.
  CheckedRobot(runtime::Runtime& runtime, std::vector<model::Network> controllers,
               std::shared_ptr<mission::CommandedRobot> inner)
      : ForwardingCommandedRobot(std::move(inner)), runtime_(runtime), controllers_(std::move(controllers)) {}

  /// From now on actions of the robot may fail.
  void expect_faults() { may_fail_ = true; }
  /// Somebody is about to take the robot over.
  void about_to_be_taken_over() { may_be_lost_ = true; }
  /// Nobody holds the lease from the moment when the robot is taken over, while its transition goes on.
  [[nodiscard]] bool is_lost() const { return !runtime_.served().lease_holder(); }
  /// What was wrong first; nothing: all was as it must be.
  [[nodiscard]] std::optional<std::string> problem() const;
  /// The controllers of the last request that was carried out.
  [[nodiscard]] std::set<std::string> running() const;
  void blame(std::string what);

  /// Blocks until the mission has been answered so often, or is over.
  void await_answers(int count) const;
  /// Nobody waits for answers any more.
  void mission_is_over() { answered(kOver); }

  Result<void> request(const mission::ControllerRequest& what, const Wait& wait) override;
  Result<mission::ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override;

 private:
  static constexpr int kOver = 1 << 30;

  void check_granted(const std::set<std::string>& names, bool was_lost);
  /// `others_asked`: a request was carried out at the same time, which may have given up what is only kept.
  void check_fine(const std::string& name, const mission::ControllerTrouble& trouble, bool was_lost,
                  bool others_asked);
  void answered(int count);

  runtime::Runtime& runtime_;
  const std::vector<model::Network> controllers_;
  std::atomic<bool> may_fail_ = false;
  std::atomic<bool> may_be_lost_ = false;
  std::atomic<int> answers_ = 0;
  std::atomic<int> requests_begun_ = 0;
  std::atomic<int> requests_ended_ = 0;
  mutable Mutex mutex_;  ///< protects the next two
  std::set<std::string> running_;
  std::optional<std::string> problem_;
};

}  // namespace segue::testing
