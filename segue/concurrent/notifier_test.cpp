// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/notifier.hpp>

#include <support/waiting_call.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <stdexcept>
#include <vector>

namespace segue::concurrent {
namespace {

using ::testing::ElementsAre;

TEST(Notifier, passes_events_on_in_their_order_on_a_thread_of_its_own) {
  Notifier<int> notifier;
  std::vector<int> got;
  std::thread::id thread;
  notifier.set_listener([&](int event) {
    got.push_back(event);
    thread = std::this_thread::get_id();
  });
  for (int i = 0; i < 3; ++i) {
    notifier.post(i);
  }
  notifier.drain();
  notifier.set_listener({});
  EXPECT_THAT(got, ElementsAre(0, 1, 2));
  EXPECT_NE(thread, std::this_thread::get_id());
}

TEST(Notifier, keeps_the_last_events_for_the_next_listener) {
  Notifier<int> notifier(2);
  for (int i = 0; i < 5; ++i) {
    notifier.post(i);
  }
  std::vector<int> got;
  notifier.set_listener([&](int event) { got.push_back(event); });
  notifier.drain();
  notifier.set_listener({});
  EXPECT_THAT(got, ElementsAre(3, 4));
}

TEST(Notifier, drops_events_without_a_listener_and_does_not_wait_for_them) {
  Notifier<int> notifier;
  notifier.post(1);
  notifier.drain();
  std::vector<int> got;
  notifier.set_listener([&](int event) { got.push_back(event); });
  notifier.post(2);
  notifier.drain();
  notifier.set_listener({});
  EXPECT_THAT(got, ElementsAre(2));
}

TEST(Notifier, waits_for_the_previous_listener_before_it_is_replaced) {
  Notifier<int> notifier;
  std::promise<void> entered;
  std::promise<void> go_on;
  std::atomic<bool> left{false};
  notifier.set_listener([&](int) {
    entered.set_value();
    go_on.get_future().wait();
    left = true;
  });
  notifier.post(1);
  entered.get_future().wait();
  segue::testing::WaitingCall replacing([&] {
    notifier.set_listener({});
    EXPECT_TRUE(left);
  });
  EXPECT_TRUE(replacing.waits());
  go_on.set_value();
}

TEST(Notifier, a_listener_that_throws_gets_the_next_event) {
  Notifier<int> notifier;
  std::vector<int> got;
  notifier.set_listener([&](int event) {
    got.push_back(event);
    throw std::runtime_error("a defect");
  });
  notifier.post(1);
  notifier.post(2);
  notifier.drain();
  notifier.set_listener({});
  EXPECT_THAT(got, ElementsAre(1, 2));
}

}  // namespace
}  // namespace segue::concurrent
