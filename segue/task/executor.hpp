// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/task/futex.hpp>
#include <segue/task/timer_heap.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace segue::task {

class Doorbell;

namespace detail {
class RunQueue;
}

/// Something that an executor runs when triggered. Tasks are jobs.
class Job : private detail::Timer {
 public:
  enum Reason : std::uint32_t {
    kSample = 1,
    kTimer = 2,
    kDescriptor = 4,
    kCall = 8,
    kRetry = 16,  ///< it missed an earlier turn
    kAllReasons = 31
  };

  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Runs on the executor's thread, once for all reasons that have accumulated. `now` is the current time;
  /// whoever reads the clock updates it. Returns when to run again without a trigger (kNever: not at all).
  virtual TimePoint run(std::uint32_t reasons, TimePoint& now) noexcept = 0;

 protected:
  ~Job() = default;
  /// When the first of the current run's reasons was triggered. Inside run() only.
  [[nodiscard]] TimePoint wanted_since() const { return running_since_; }

 private:
  friend class detail::RunQueue;
  static constexpr std::uint32_t kQueued = 1U << 30;
  static constexpr std::uint32_t kRetire = 1U << 31;

  std::atomic<std::uint32_t> flags_{0};  ///< reasons, kQueued and kRetire; memory order: see RunQueue
  std::atomic<std::uint32_t> retired_{0};
  Job* next_ = nullptr;
  TimePoint wanted_since_{};   ///< written by whoever set kQueued
  TimePoint running_since_{};  ///< used by the runner only
};

/// Runs jobs sequentially on one thread.
class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor() = default;

  /// Requests a run; requests before the run are merged. Any thread; real-time safe.
  virtual void trigger(Job& job, Job::Reason reason) noexcept = 0;
  /// Removes a job, which nobody may trigger any more; waits while it runs, unless called from inside it.
  virtual void remove(Job& job) = 0;
  /// Triggers the job (kDescriptor) once when the descriptor becomes readable; rearm() after each run.
  virtual Result<void> watch(Job& job, int descriptor) = 0;
  virtual void rearm(Job& job, int descriptor) noexcept = 0;
  virtual void unwatch(int descriptor) noexcept = 0;

  /// The doorbell with which other processes wake this executor; it stays the same. `make` creates it on the
  /// first call and may return nullptr. Any thread; allocates. ResourceExhausted.
  using DoorbellMaker = std::function<std::shared_ptr<Doorbell>()>;
  virtual Result<std::shared_ptr<Doorbell>> doorbell(const DoorbellMaker& make) = 0;

  /// Whether the caller is the thread that runs the jobs.
  [[nodiscard]] virtual bool is_current() const noexcept = 0;
  [[nodiscard]] virtual Clock& clock() noexcept = 0;

  /// Processor time of the thread so far, and how long it was awake. Any thread.
  struct Usage {
    Duration cpu{0};
    Duration busy{0};
  };
  [[nodiscard]] virtual Usage usage() const = 0;
};

}  // namespace segue::task
