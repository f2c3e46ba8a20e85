// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace segue::cli {

/// SIGINT and SIGTERM as something that can be waited for. The first asks to end; a second, a fifth of a
/// second later or more, ends the process at once with status 130. Make one before any other thread, since it
/// blocks the signals for all of them, and end it on the same thread, which then takes signals as before; but
/// for a process that was told to end, which is on its way.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// From any thread: as if a signal had come.
  void request(const std::string& reason);
  /// Why to end; waits until `deadline`, or for ever.
  std::optional<std::string> wait(std::optional<TimePoint> deadline);
  [[nodiscard]] bool requested();
  /// Stop is requested of it when a signal comes, or by request().
  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }

 private:
  void listen();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::string> reason_;
  std::stop_source stop_;
  bool signalled_ = false;  ///< the listener's, until it has ended
  int wake_ = -1;
  sigset_t before_{};
  std::thread thread_;
};

}  // namespace segue::cli
