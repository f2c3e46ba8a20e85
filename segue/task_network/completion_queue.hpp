// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_network/environment.hpp>

#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace segue::task_network {

enum class ClockKind : std::uint8_t { Virtual, Real };

/// The ends of nodes. With a virtual clock, they come in the order of their time, and time jumps to the next
/// one unless the end of a real action is awaited; with a real clock, `next` waits until an end is known.
/// Each end carries the time at which it happened, which is earlier than the time at which it is taken. Ends
/// at equal times keep the order in which they were reported, so equal calls give equal runs. All functions
/// belong to the engine's thread, except `finish`.
class CompletionQueue final : public Completions {
 public:
  struct End {
    TimePoint when;
    NodeId node{};
    std::uint32_t attempt = 0;
    ReportPtr report;
  };

  explicit CompletionQueue(ClockKind clock);

  /// Time counts from now on; otherwise from the construction on.
  void begin();
  void await(NodeId node, std::uint32_t attempt) override;
  void finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) override;
  void finish(NodeId node, std::uint32_t attempt, ReportPtr report) override;
  [[nodiscard]] TimePoint now() const override { return clock_ == ClockKind::Real ? elapsed() : now_; }
  /// Differences of times up to this are what the engine takes itself to go from one node to the next.
  [[nodiscard]] Duration own_time() const;
  /// Real time since this began, whatever the clock.
  [[nodiscard]] TimePoint elapsed() const;

  /// Another end that was due when the last one was taken, if it is known already. Does not block.
  template <class Counts>
  std::optional<End> next_now(Counts&& counts) {
    drop_unless(counts);
    if (due()) return take_first_due();
    if (later_.empty() || later_.front().when > now_) return std::nullopt;
    return take_due();
  }

  /// The next end for which `counts` is true; others are dropped without time passing. Nullopt if none is
  /// scheduled and, with `awaited`, none arrives from another thread before `elapsed` reaches `deadline`.
  /// Blocks only if `awaited`.
  template <class Counts>
  std::optional<End> next(bool awaited, TimePoint deadline, Counts&& counts) {
    for (;;) {
      drop_unless(counts);
      if (auto end = take_due()) return end;
      if (!awaited || !wait(deadline)) return std::nullopt;
    }
  }

  /// Virtual time goes on without the ends that other threads were to post; false if there are none.
  bool give_up_awaited() { return !std::exchange(awaited_, {}).empty(); }

 private:
  struct Scheduled {
    TimePoint when;
    std::uint64_t number = 0;
    NodeId node{};
    std::uint32_t attempt = 0;
    ReportPtr report;
    friend bool operator<(const Scheduled& a, const Scheduled& b) {  // the earliest is the heap's greatest
      return a.when != b.when ? a.when > b.when : a.number > b.number;
    }
  };
  template <class Counts>
  void drop_unless(Counts& counts) {
    while (due() && !counts(due_[taken_]))
      take_first_due();
    while (!later_.empty() && !counts(later_.front()))
      take_later();
  }
  [[nodiscard]] bool due() const { return taken_ < due_.size(); }
  End take_first_due() {
    End first = std::move(due_[taken_++]);
    if (!due()) {
      due_.clear();
      taken_ = 0;
    }
    return first;
  }
  Scheduled take_later();
  std::optional<End> take_due();
  [[nodiscard]] bool stands_still() const;
  bool wait(TimePoint deadline);
  void fetch_posted() SEGUE_REQUIRES(mutex_);

  const ClockKind clock_;
  TimePoint began_ = RealClock::instance().now();  ///< written by the engine's thread, with the mutex
  TimePoint now_{};                                ///< on a real clock, that of the last look at it
  std::uint64_t number_ = 0;
  std::vector<End> due_;                                       ///< in the order in which they are taken
  std::size_t taken_ = 0;                                      ///< of due_; all are taken before time goes on
  std::vector<Scheduled> later_;                               ///< a heap
  std::set<std::pair<std::uint32_t, std::uint32_t>> awaited_;  ///< node and attempt; only in virtual time
  Mutex mutex_;  ///< protects began_ and posted_, through which other threads hand over ends
  ConditionVariable arrived_;
  std::vector<End> posted_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_network
