// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/task/executor.hpp>

#include <memory>
#include <string>

namespace segue::task {

/// Runs jobs on a thread of its own, which sleeps when there is nothing to do, after looking for work for as
/// long as Activity::spin says. Jobs that trigger others on
/// the same executor need no wake-up.
class ThreadExecutor final : public Executor {
 public:
  /// The thread gets `name` (cut at 15 bytes) and the scheduler, priority and processors of `activity`.
  /// InvalidArgument for a priority, a processor or a spin that cannot be; PermissionDenied where the system
  /// refuses these, unless they are optional.
  static Result<std::shared_ptr<ThreadExecutor>> create(const std::string& name, const Activity& activity);
  /// Requires that all jobs were removed. Waits for the thread, unless called from it.
  ~ThreadExecutor() override;

  /// Wakes the thread, if it sleeps, at the end of the caller's detail::WakeBatch, if there is one.
  void trigger(Job& job, Job::Reason reason) noexcept override;
  void remove(Job& job) override;
  Result<void> watch(Job& job, int descriptor) override;
  void rearm(Job& job, int descriptor) noexcept override;
  void unwatch(int descriptor) noexcept override;
  Result<std::shared_ptr<Doorbell>> doorbell(const DoorbellMaker& make) override;
  [[nodiscard]] bool is_current() const noexcept override;
  [[nodiscard]] Clock& clock() noexcept override { return RealClock::instance(); }
  [[nodiscard]] Usage usage() const override;
  /// Whether the thread runs under the requested scheduler (false: optional and not permitted).
  [[nodiscard]] bool scheduler_granted() const { return granted_; }

 private:
  struct State;
  explicit ThreadExecutor(std::shared_ptr<State> state) : state_(std::move(state)) {}

  std::shared_ptr<State> state_;
  bool granted_ = true;
};

}  // namespace segue::task
