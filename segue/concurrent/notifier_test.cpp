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

TEST(Notifier, PassesEventsOnInTheirOrderOnAThreadOfItsOwn) {
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

TEST(Notifier, KeepsTheLastEventsForTheNextListener) {
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

TEST(Notifier, DropsEventsWithoutAListenerAndDoesNotWaitForThem) {
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

TEST(Notifier, WaitsForThePreviousListenerBeforeItIsReplaced) {
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

TEST(Notifier, AListenerThatThrowsGetsTheNextEvent) {
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
