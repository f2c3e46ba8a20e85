// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/task/futex.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace segue::task {

class Doorbell;

namespace detail {
class RunQueue;
}

/// Something that an executor runs when there is a reason to. Tasks are jobs.
class Job {
 public:
  enum Reason : std::uint32_t {
    kSample = 1,
    kTimer = 2,
    kDescriptor = 4,
    kCall = 8,
    kRetry = 16,  ///< it could not run when it was asked to
    kAllReasons = 31
  };

  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// On the executor's thread, for all reasons that came together. `now` is the time, to be moved on by who
  /// reads the clock. Answers when to run again by itself (kNever: not at all).
  virtual TimePoint run(std::uint32_t reasons, TimePoint& now) noexcept = 0;

 protected:
  ~Job() = default;
  /// When the first of the reasons that run() got came up. Inside run().
  [[nodiscard]] TimePoint wanted_since() const { return running_since_; }

 private:
  friend class detail::RunQueue;
  static constexpr std::uint32_t kQueued = 1U << 30;
  static constexpr std::uint32_t kRetire = 1U << 31;

  std::atomic<std::uint32_t> flags_{0};
  std::atomic<std::uint32_t> retired_{0};
  Job* next_ = nullptr;
  TimePoint wanted_since_{};   ///< of whoever queued it
  TimePoint running_since_{};  ///< of the runner
  TimePoint due_{};
  std::size_t timer_ = kNoTimer;
  static constexpr std::size_t kNoTimer = static_cast<std::size_t>(-1);
};

/// Runs jobs one after the other on one thread.
class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor() = default;

  /// Asks for a run. Any thread; real-time safe; no memory of how often.
  virtual void trigger(Job& job, Job::Reason reason) noexcept = 0;
  /// Prepares for a job, so that running it allocates nothing. Not real-time.
  virtual void add(Job& job) = 0;
  /// Forgets a job, which nobody triggers any more; waits while it runs, unless called from inside.
  virtual void remove(Job& job) = 0;
  /// Triggers the job (kDescriptor) once when the descriptor is readable; watch again (rearm) after each run.
  virtual Result<void> watch(Job& job, int descriptor) = 0;
  virtual void rearm(Job& job, int descriptor) noexcept = 0;
  virtual void unwatch(int descriptor) noexcept = 0;

  /// The doorbell by which other processes wake this executor, for good; `make` makes it when it is first
  /// asked for (nullptr: it cannot). Any thread; allocates. ResourceExhausted.
  using DoorbellMaker = std::function<std::shared_ptr<Doorbell>()>;
  virtual Result<std::shared_ptr<Doorbell>> doorbell(const DoorbellMaker& make) = 0;

  /// Whether the caller is the thread that runs the jobs.
  [[nodiscard]] virtual bool is_current() const noexcept = 0;
  [[nodiscard]] virtual Clock& clock() noexcept = 0;

  /// What the thread has used so far, and how long it was not asleep. Any thread.
  struct Usage {
    Duration cpu{0};
    Duration busy{0};
  };
  [[nodiscard]] virtual Usage usage() const = 0;
};

}  // namespace segue::task
