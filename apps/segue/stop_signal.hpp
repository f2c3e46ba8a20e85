// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

#include <csignal>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace segue::cli {

/// Makes SIGINT and SIGTERM an event that can be waited for. The first signal asks to end; a second one, at
/// least a fifth of a second later, ends the process at once with status 130. Create it before any other
/// thread, because it blocks the signals for all of them, and destroy it on the same thread, which then
/// handles signals as before, unless the process has already been asked to end.
class StopSignal {
 public:
  /// The end of `input` (nobody writes to it any more) asks to end as well; -1: only signals do.
  explicit StopSignal(int input = -1);
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Has the effect of a signal. Any thread may call it.
  void request(const std::string& reason);
  /// Blocks until there is a reason to end, or until `deadline`. Returns the reason.
  std::optional<std::string> wait(std::optional<TimePoint> deadline);
  [[nodiscard]] bool requested();
  /// Stop is requested of it when a signal comes, or by request().
  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }

 private:
  void listen(int input);

  Mutex mutex_;
  ConditionVariable changed_;
  std::optional<std::string> reason_ SEGUE_GUARDED_BY(mutex_);
  std::stop_source stop_;
  bool signalled_ = false;  ///< used by the listener thread only, until it has ended
  int wake_ = -1;
  sigset_t before_{};
  std::thread thread_;
};

}  // namespace segue::cli
