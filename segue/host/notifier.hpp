// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace segue::host::detail {

/// Tells a listener of events, on a thread of its own: those who report must not wait for those who listen.
class Notifier {
 public:
  /// An event, made ready to be told on the notifier's thread; nothing if it is void by then.
  using Make = std::function<std::optional<TaskEvent>()>;

  Notifier() = default;
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  ~Notifier();

  /// No call is under way any more when it returns. Not from inside a listener.
  void set_listener(TaskHost::Listener listener);
  /// From any thread. Dropped where nobody listens.
  void post(Make make);

 private:
  void run();
  void halt();

  std::mutex setting_;  ///< one set_listener at a time
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Make> waiting_;
  bool running_ = false;
  TaskHost::Listener listener_;
  std::thread thread_;
};

}  // namespace segue::host::detail
