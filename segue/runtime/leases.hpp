// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/control/robot_lease.hpp>
#include <segue/runtime/change_count.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/holder_inbox.hpp>
#include <segue/runtime/mission_reports.hpp>
#include <segue/runtime/runtime.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime::detail {

/// Who may request controllers (ServedRuntime::take_lease). The number of a lease is a secret of its holder:
/// whoever names it commands, so it is random, and in nothing that others can read. Thread safe; nothing
/// blocks.
class Leases {
 public:
  /// `log` gets an event for each change, `journal` what missions report; `changes` counts. All must outlive
  /// this.
  Leases(EventLog& log, JournalKeeper& journal, ChangeCount& changes)
      : log_(log), changes_(changes), missions_(journal) {}

  Result<std::uint64_t> take(std::string holder);
  struct Holder {
    std::string name;
    std::uint64_t number = 0;
    bool keeps = false;          ///< it has said that the robot runs on, however it ends
    bool halts_at_stop = false;  ///< it has said that the robot comes to rest at once where it is stopped
    bool is_stopped = false;
  };
  /// Nothing where nobody holds it with that number.
  [[nodiscard]] std::optional<Holder> holder_of(std::uint64_t number) const;
  [[nodiscard]] std::optional<Holder> holder() const;
  /// Its holder commands nothing any more, and only says how it ends.
  void stop(std::uint64_t number);
  void end(std::uint64_t number);
  /// From whoever holds it; `by` says who does.
  void take_away(const std::string& by);
  [[nodiscard]] control::LeaseStanding standing_of(std::uint64_t number) const;
  /// Why nothing is done with that lease any more; nothing for 0, which is none.
  [[nodiscard]] std::optional<Error> refusal_of(std::uint64_t lease) const;
  /// Records what the holder says that it is doing (control::RobotService::report).
  Result<void> report(std::uint64_t number, type::Value doing);
  [[nodiscard]] type::Value doing() const;
  /// The mission that commands the robot, or the last one that did, with what happened after entry `after`;
  /// null where there was none. Asks the holder for its plan where that is wanted and not known.
  /// A mission has not ended before the robot is at rest: `halts`, whether it comes to rest now; or
  /// `halts_after`, once the lease ends.
  [[nodiscard]] type::Value mission(std::uint64_t after, bool with_plan, bool halts, bool halts_after);
  Result<std::uint64_t> ask(std::string_view what, const type::Value& arguments);
  std::vector<control::HolderRequest> take_commands(std::uint64_t number);
  /// Why a request with these options is not accepted.
  [[nodiscard]] std::optional<Error> refusal_of(const RequestOptions& options) const;
  /// Whether a request with these options takes the robot over from somebody.
  [[nodiscard]] bool would_take_over(const RequestOptions& options) const;
  /// Whether this sender may do something with tasks that is no request. InvalidState where the lease is
  /// another's.
  Result<void> allow(const Sender& sender, const std::string& what);
  /// Takes the robot over where the options of an accepted request say so.
  void take_over(const RequestOptions& options);

 private:
  struct Lease {
    std::uint64_t number = 0;
    std::string holder;
    type::Value doing{};
    HolderInbox inbox{};
    bool shall_show_plan = false;
    bool is_stopped = false;
  };
  [[nodiscard]] std::optional<std::string> who_took(std::uint64_t number) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_holder(std::uint64_t lease) const SEGUE_REQUIRES(mutex_) {
    return held_ && held_->number == lease;
  }
  [[nodiscard]] bool takes_over(const RequestOptions& options) const SEGUE_REQUIRES(mutex_) {
    return options.take_over && held_ && !is_holder(options.lease);
  }
  /// Whoever holds it holds it no longer; `how` ends the mission that it ran.
  void lose(const std::string& to, const std::string& how) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::optional<Error> why_refused(std::uint64_t lease) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::optional<Holder> present_holder() const SEGUE_REQUIRES(mutex_);

  EventLog& log_;
  ChangeCount& changes_;
  mutable Mutex mutex_;  ///< protects all below
  MissionReports missions_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Lease> held_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Lease> lost_ SEGUE_GUARDED_BY(mutex_);  ///< the last that was taken over; `holder` did so
};

}  // namespace segue::runtime::detail
