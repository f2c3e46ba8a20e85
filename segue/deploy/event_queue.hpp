// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

namespace segue::deploy::detail {

/// Tells a listener of events in their order, on a thread of its own: those who report must not wait for
/// those who listen. All functions may be called from any thread.
class EventQueue {
 public:
  EventQueue() = default;
  ~EventQueue() { halt(); }
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  /// The listener gets what has been pushed since nobody listened (the last few hundred). No call of the old
  /// one is under way any more when this returns. Not from inside a listener.
  void set_listener(host::TaskHost::Listener listener);
  void push(host::HostEvent event);
  /// Returns when all that was pushed before has been told, or nobody listens. Not from inside a listener.
  void drain();

 private:
  void run();
  void halt();

  std::mutex setting_;  ///< one set_listener at a time
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<host::HostEvent> waiting_;
  std::uint64_t pushed_ = 0;
  std::uint64_t told_ = 0;
  bool running_ = false;
  host::TaskHost::Listener listener_;
  std::thread thread_;
};

}  // namespace segue::deploy::detail
