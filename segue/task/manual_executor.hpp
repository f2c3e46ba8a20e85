// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/executor.hpp>

#include <memory>
#include <thread>

namespace segue {
class VirtualClock;
}

namespace segue::task {

/// Runs jobs only when told to, on a virtual clock: for tests, simulation and single stepping. Any thread may
/// trigger; the thread that created it runs the jobs and counts as the executor's own.
class ManualExecutor final : public Executor {
 public:
  explicit ManualExecutor(VirtualClock& clock);
  ~ManualExecutor() override;

  /// Runs the jobs that are ready, and those that become ready, up to `limit`. Returns their number.
  std::size_t run_ready(std::size_t limit = 1'000'000);
  /// Advances the clock, running every timed job at its time.
  void advance(Duration step);

  void trigger(Job& job, Job::Reason reason) noexcept override;
  void remove(Job& job) override;
  /// Descriptors are polled in run_ready().
  Result<void> watch(Job& job, int descriptor) override;
  void rearm(Job& job, int descriptor) noexcept override;
  void unwatch(int descriptor) noexcept override;
  /// Answered in run_ready().
  Result<std::shared_ptr<Doorbell>> doorbell(const DoorbellMaker& make) override;
  [[nodiscard]] bool is_current() const noexcept override;
  [[nodiscard]] Clock& clock() noexcept override;
  /// Always zero, since virtual time uses no processor.
  [[nodiscard]] Usage usage() const override { return {}; }

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task
