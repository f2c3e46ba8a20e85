// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/environment.hpp>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

namespace segue::cdtn {

enum class ClockKind : std::uint8_t { Virtual, Real };

/// The ends of nodes in the order of their time. With a virtual clock, time jumps to the next end; with a
/// real one, `next` waits for it. Ends at equal times keep the order in which they were reported, so equal
/// calls give equal runs. All functions belong to the engine's thread, except `finish`.
class CompletionQueue final : public Completions {
 public:
  struct End {
    TimePoint when;
    NodeId node{};
    std::uint32_t attempt = 0;
    ReportPtr report;
  };

  explicit CompletionQueue(ClockKind clock);

  void finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) override;
  void finish(NodeId node, std::uint32_t attempt, ReportPtr report) override;
  [[nodiscard]] TimePoint now() const override { return now_; }
  /// Real time since this began, whatever the clock.
  [[nodiscard]] TimePoint elapsed() const;

  /// Another end at the current time, if one is known already. Does not block.
  template <class Counts>
  std::optional<End> next_now(Counts&& counts) {
    drop_unless(counts);
    if (due_.empty() && (later_.empty() || later_.front().when > now_)) return std::nullopt;
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
    while (!due_.empty() && !counts(due_.front()))
      due_.pop_front();
    while (!later_.empty() && !counts(later_.front()))
      take_later();
  }
  Scheduled take_later();
  std::optional<End> take_due();
  bool wait(TimePoint deadline);
  void fetch_posted();

  const ClockKind clock_;
  const TimePoint began_ = RealClock::instance().now();
  TimePoint now_{};
  std::uint64_t number_ = 0;
  std::deque<End> due_;           ///< at the current time
  std::vector<Scheduled> later_;  ///< a heap
  std::mutex mutex_;              ///< protects only posted_, through which other threads hand over ends
  std::condition_variable arrived_;
  std::vector<End> posted_;
};

}  // namespace segue::cdtn
