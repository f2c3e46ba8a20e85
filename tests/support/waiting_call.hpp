// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/eventually.hpp>

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <utility>

namespace segue::testing {

/// A call on a thread of its own that has to wait until the test lets it go on. Joins its thread at the end.
class WaitingCall {
 public:
  explicit WaitingCall(std::function<void()> call)
      : thread_([this, call = std::move(call)] {
          id_ = ::gettid();
          call();
          returned_ = true;
        }) {}

  [[nodiscard]] bool returned() const { return returned_; }
  /// Whether the thread stands still inside the call: false if the call has returned instead.
  [[nodiscard]] bool waits() const {
    return eventually([this] { return returned_ || stands_still(); }) && !returned_;
  }
  void join() { thread_.join(); }

 private:
  /// As the system says: what runs, or may run as soon as a processor is free, does not wait.
  [[nodiscard]] bool stands_still() const {
    const pid_t id = id_;
    std::ifstream file("/proc/self/task/" + std::to_string(id) + "/stat");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const auto name_end = text.rfind(')');
    return id != 0 && name_end != std::string::npos && text.substr(name_end, 3) == ") S";
  }

  std::atomic<pid_t> id_{0};
  std::atomic<bool> returned_{false};
  std::jthread thread_;
};

}  // namespace segue::testing
