// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/taken_instance.hpp>
#include <segue/runtime/instance_calls.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/process_memory.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime::detail {

/// Gives the instances of pools to callers, each to one at a time, and decides how many instances a pool
/// shall have: as many as callers wait for, between its least and its most, within the budget. Knows only
/// what it is told, and has no clock of its own. Thread safe; nothing blocks.
class InstanceAllocator {
 public:
  /// How long an instance is kept for a caller that has got it and has not called it yet.
  static constexpr Duration kReserved = std::chrono::seconds(5);
  /// How long a caller waits while no instance is ready, before it gets an error.
  static constexpr Duration kReadyDeadline = std::chrono::seconds(30);

  /// All must outlive this.
  InstanceAllocator(const std::vector<model::Pool>& pools, const model::PoolBudget& budget,
                    InstanceCalls& calls);

  /// An instance that is ready and works for nobody, which is the caller's for its next call; nothing: there
  /// is none yet. Unavailable where none is likely to come, NotFound where there is no such pool. `since`:
  /// when the caller has begun to wait.
  [[nodiscard]] std::optional<Result<model::TakenInstance>> take(const model::InstanceQuestion& what,
                                                                 TimePoint since, TimePoint now);
  /// A caller waits from now on; whether the pool may get another instance for it.
  bool begin_waiting(std::string_view pool);
  void end_waiting(std::string_view pool);
  /// A call of this task has ended.
  void used(const model::TaskId& task, TimePoint now);

  /// How supervision has seen the pools, at `when` or later. An instance that was lost since then counts as
  /// lost until a later report.
  void note(const std::vector<PoolReport>& seen, TimePoint when);
  /// The instance has ended, or does not run any more.
  void lost(const model::TaskId& task, const std::string& why, TimePoint now);

  /// An instance that is to be made because callers wait; it does not count before add(). Nothing: none is.
  [[nodiscard]] std::optional<model::TaskId> next_to_make(TimePoint now, const MemoryOf& memory_of);
  void add(const model::TaskId& task, TimePoint now);
  /// An instance beyond the least number that nobody has needed for as long as its pool says: it takes no
  /// calls and counts no more, and is to be stopped. Nothing: there is none.
  [[nodiscard]] std::optional<model::TaskId> next_to_leave(TimePoint now);
  /// Each pool has its least number of instances, as at first.
  void reset();

  /// Whether that instance shall run.
  [[nodiscard]] bool is_wanted(const model::TaskId& task) const;
  /// Each pool with the names of the instances that shall run.
  [[nodiscard]] std::vector<PoolReport> pools() const;

 private:
  struct Instance {
    int number = 0;
    PoolInstance seen;
    TimePoint last_used{};
    TimePoint reserved_until{};
    TimePoint lost_at{};
  };
  struct State {
    const model::Pool& pool;
    std::vector<Instance> instances{};  ///< that shall run, in the order of their numbers
    int waiting = 0;
    TimePoint last_ready{};
    std::string held_back{};
  };

  State* find(std::string_view pool) SEGUE_REQUIRES(mutex_);
  Instance* find_instance(const model::TaskId& task) SEGUE_REQUIRES(mutex_);
  static void lose(Instance& one, const std::string& why, TimePoint now);
  [[nodiscard]] bool works(const Instance& one, TimePoint now) const SEGUE_REQUIRES(mutex_);
  /// How many callers wait for more instances than will be free.
  [[nodiscard]] int shortage(const State& state, TimePoint now) const SEGUE_REQUIRES(mutex_);
  /// Why the budget permits no further instance; empty: it does.
  [[nodiscard]] std::string refusal(const State& state, const MemoryOf& memory_of) const
      SEGUE_REQUIRES(mutex_);
  static Instance named(const model::Pool& pool, int number);

  const model::PoolBudget& budget_;
  InstanceCalls& calls_;
  mutable Mutex mutex_;  ///< taken before that of the calls
  std::vector<State> states_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail
