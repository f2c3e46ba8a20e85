// SPDX-License-Identifier: Apache-2.0
#include "iceoryx_peer.hpp"
#include "joining.hpp"

#include <sched.h>

#include <thread>
#include <vector>

namespace bench {
namespace {

using Publisher = iox::popo::UntypedPublisher;
using Subscriber = iox::popo::UntypedSubscriber;

bool take(Subscriber& subscriber) {
  bool taken = false;
  subscriber.take().and_then([&](const void* sample) {
    subscriber.release(sample);
    taken = true;
  });
  return taken;
}

class IceoryxJoining final : public Joining {
 public:
  [[nodiscard]] std::string name() const override { return "iceoryx"; }

  void offer(const End& end, std::size_t topics) override {
    join_iceoryx("bench-offer");
    iox::popo::PublisherOptions options;
    options.historyCapacity = 1;
    std::vector<std::unique_ptr<Publisher>> publishers;
    for (std::size_t i = 0; i < topics; ++i) {
      publishers.push_back(std::make_unique<Publisher>(iceoryx_topic(topic_name(i)), options));
      publishers.back()->loan(sizeof(Stamp)).and_then([&](void* sample) {
        new (sample) Stamp;
        publishers.back()->publish(sample);
      });
    }
    end.board.word.store(1, std::memory_order_release);
    wait_for_the_other(end);
  }

  bool join(const End& end, std::size_t topics, std::size_t repeat) override {
    join_iceoryx("bench-join");
    while (end.board.word.load(std::memory_order_acquire) == 0)
      ::sched_yield();
    iox::popo::SubscriberOptions options;
    options.queueCapacity = 1;
    options.historyRequest = 1;
    for (std::size_t round = 0; round < repeat; ++round) {
      std::vector<std::unique_ptr<Subscriber>> subscribers;
      const std::int64_t begin = clock_ns();
      for (std::size_t i = 0; i < topics; ++i)
        subscribers.push_back(std::make_unique<Subscriber>(iceoryx_topic(topic_name(i)), options));
      for (auto& subscriber : subscribers) {
        while (!take(*subscriber))
          ::sched_yield();
      }
      end.board.add_result(Duration(clock_ns() - begin));
      subscribers.clear();
      // RouDi removes them periodically; it has room for about a thousand.
      if (topics > 1) std::this_thread::sleep_for(std::chrono::milliseconds(250));
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Joining> make_iceoryx_joining() {
  return std::make_unique<IceoryxJoining>();
}

}  // namespace bench
