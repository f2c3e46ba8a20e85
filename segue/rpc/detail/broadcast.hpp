// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/rpc/detail/event_loop.hpp>

#include <kj/async.h>
#include <kj/function.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <set>
#include <utility>
#include <vector>

namespace segue::control::detail {

/// Passes events of a service to the clients that listen. Never waits for a client: one that does not keep up
/// loses the oldest events and gets their number.
template <class Event>
class Broadcast {
 public:
  static constexpr std::size_t kMaxWaiting = 4096;  ///< for the event loop, and for each listener
  static constexpr std::size_t kMaxInMessage = 256;

  using Events = std::vector<Event>;
  /// Sends events, and how many before them were lost; resolves when the client has taken them.
  using Send = kj::Function<kj::Promise<void>(const Events& events, std::uint64_t lost)>;

  /// A client that listens, until it is destroyed. One message at a time is on its way.
  class Listener final : private kj::TaskSet::ErrorHandler {
   public:
    Listener(Broadcast& source, Send send) : source_(source), send_(kj::mv(send)), sending_(*this) {
      source_.listeners_.insert(this);
    }
    ~Listener() noexcept { source_.listeners_.erase(this); }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

   private:
    friend class Broadcast;

    void take(const Event& event) {
      if (waiting_.size() >= kMaxWaiting) {
        waiting_.pop_front();
        ++lost_;
      }
      waiting_.push_back(event);
    }

    void pump() {
      if (busy_ || waiting_.empty()) return;
      const auto end =
          waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(waiting_.size(), kMaxInMessage));
      const Events events(waiting_.begin(), end);
      waiting_.erase(waiting_.begin(), end);
      busy_ = true;
      sending_.add(kj::evalNow([&] { return send_(events, std::exchange(lost_, 0)); }).then([this] {
        busy_ = false;
        pump();
      }));
    }

    /// The client is gone or refuses events: the listener stays busy, so no more are sent.
    void taskFailed(kj::Exception&&) override { waiting_.clear(); }

    Broadcast& source_;
    Send send_;
    std::deque<Event> waiting_;
    std::uint64_t lost_ = 0;
    bool busy_ = false;
    kj::TaskSet sending_;
  };

  /// From any thread; returns at once.
  void tell(const Event& event, EventLoop& loop) {
    const Lock lock(mutex_);
    if (waiting_.size() >= kMaxWaiting) {
      waiting_.pop_front();
      ++lost_;
    }
    waiting_.push_back(event);
    if (!posted_) posted_ = loop.post([this](kj::AsyncIoContext&) { hand_out(); });
  }

 private:
  void hand_out() {
    std::deque<Event> events;
    std::uint64_t lost = 0;
    {
      const Lock lock(mutex_);
      posted_ = false;
      events.swap(waiting_);
      lost = std::exchange(lost_, 0);
    }
    for (Listener* listener : listeners_) {
      listener->lost_ += lost;
      for (const Event& event : events)
        listener->take(event);
      listener->pump();
    }
  }

  Mutex mutex_;
  std::deque<Event> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t lost_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool posted_ SEGUE_GUARDED_BY(mutex_) = false;
  std::set<Listener*> listeners_;  ///< used in the loop's thread only
};

}  // namespace segue::control::detail
