// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/holder_inbox.hpp>
#include <segue/runtime/mission_reports.hpp>
#include <segue/runtime/runtime.hpp>

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime::detail {

/// Who may request controllers (Runtime::take_lease). Thread safe; nothing blocks.
class Leases {
 public:
  /// `log` gets an event for each change, `journal` what missions report. Both must outlive this.
  Leases(EventLog& log, JournalKeeper& journal) : log_(log), missions_(journal) {}

  Result<std::uint64_t> take(std::string holder);
  void end(std::uint64_t number);
  [[nodiscard]] std::optional<std::string> lost_to(std::uint64_t number) const;
  [[nodiscard]] std::optional<std::string> holder() const;
  /// What the holder does, and what it has been asked to do (control::RobotService::report, ask_holder).
  Result<void> report(std::uint64_t number, type::Value doing);
  [[nodiscard]] type::Value doing() const;
  /// As of control::RobotService::mission. Asks the holder for its plan where that is wanted and not known.
  [[nodiscard]] type::Value mission(std::uint64_t after, bool with_plan);
  Result<std::uint64_t> ask(std::string_view what, const type::Value& arguments);
  std::vector<control::HolderRequest> take_asked(std::uint64_t number);
  /// Why a request with these options is not accepted. Where they say so, the robot is taken over.
  std::optional<Error> refusal_of(const RequestOptions& options);

 private:
  struct Lease {
    std::uint64_t number = 0;
    std::string holder;
    type::Value doing{};
    HolderInbox inbox{};
    bool shall_show_plan = false;
  };
  [[nodiscard]] std::optional<std::string> who_took(std::uint64_t number) const;

  EventLog& log_;
  mutable std::mutex mutex_;  ///< protects all below
  std::uint64_t taken_ = 0;   ///< leases so far
  MissionReports missions_;
  std::optional<Lease> held_;
  std::optional<Lease> lost_;  ///< the last that was taken over; `holder` did so
};

}  // namespace segue::runtime::detail
