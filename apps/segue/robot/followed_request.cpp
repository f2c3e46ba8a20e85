// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include "../connection.hpp"
#include "followed_request.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// Shows progress on a terminal, through a connection of its own.
class ProgressWatcher {
 public:
  explicit ProgressWatcher(const Context& context) {
    if (context.json() || !progress_.active()) return;
    auto robot = connect_to(context.robot);
    if (robot) thread_ = std::thread([this, connection = std::move(*robot)] { watch(*connection); });
  }
  ~ProgressWatcher() {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
  }
  ProgressWatcher(const ProgressWatcher&) = delete;
  ProgressWatcher& operator=(const ProgressWatcher&) = delete;

 private:
  void watch(control::RobotService& robot) {
    std::uint64_t last = last_number(robot.events(0, {}));
    int done = 0;
    while (!ended_) {
      const auto events = robot.events(last, std::chrono::milliseconds(100));
      if (!events || !events->is_list()) return;
      for (const Value& event : events->as_list()) {
        last = static_cast<std::uint64_t>(number_at(event, "number"));
        done += printable_at(event, "kind") == "action_done" ? 1 : 0;
        progress_.show(fmt::format("{} actions done: {}", done, printable_at(event, "subject")));
      }
    }
  }

  static std::uint64_t last_number(const Result<Value>& events) {
    if (!events || !events->is_list() || events->as_list().empty()) return 0;
    return static_cast<std::uint64_t>(number_at(events->as_list().back(), "number"));
  }

  Progress progress_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// Ctrl-C cancels the request that is waited for; a second one ends this program, and the robot goes on.
class CancelOnSignal {
 public:
  CancelOnSignal(std::string who, StopSignal& signal, const Context& context) : who_(std::move(who)) {
    auto socket = control::socket_path(context.robot);
    socket_ = socket ? *socket : std::filesystem::path();
    stop_.emplace(signal.token(), Act{this});
  }
  ~CancelOnSignal() {
    stop_.reset();  // from here on no thread begins
    if (thread_.joinable()) thread_.join();
  }
  CancelOnSignal(const CancelOnSignal&) = delete;
  CancelOnSignal& operator=(const CancelOnSignal&) = delete;

 private:
  struct Act {
    CancelOnSignal* self;
    void operator()() const {
      self->thread_ = std::thread([self = self] { self->cancel(); });
    }
  };

  void cancel() {
    const auto robot = control::connect(socket_);
    const auto status = robot ? (*robot)->status() : Result<Value>(robot.error());
    if (!status) return print_note("cannot cancel: " + status.error().message);
    for (const Value& request : list_at(*status, "requests")) {
      if (!printable_at(request, "who").ends_with(who_)) continue;
      print_note("cancelling; Ctrl-C again to detach");
      const auto number = static_cast<std::uint64_t>(number_at(request, "request"));
      const auto answer = (*robot)->cancel(number, who_, deadline_in(std::chrono::minutes(1)));
      if (!answer) print_note("not cancelled: " + answer.error().message);
      return;
    }
    print_note("not cancelled: the robot has no such request in progress");
  }

  const std::string who_;
  std::filesystem::path socket_;
  std::thread thread_;
  std::optional<std::stop_callback<Act>> stop_;  ///< uses all above
};

}  // namespace

Result<Value> follow_request(const std::string& who, StopSignal* signal, const Context& context,
                             const std::function<Result<Value>()>& request) {
  std::optional<CancelOnSignal> canceller;
  if (signal != nullptr) canceller.emplace(who, *signal, context);
  const ProgressWatcher watcher(context);
  return request();
}

}  // namespace segue::cli
