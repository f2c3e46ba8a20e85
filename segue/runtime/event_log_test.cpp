// SPDX-License-Identifier: Apache-2.0
#include <segue/base/wait.hpp>
#include <segue/runtime/event_log.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace segue::runtime::detail {
namespace {

std::vector<Event> all_of(const EventLog& log) {
  return log.after(0, {});
}
auto count(const std::vector<Event>& events, EventKind kind) {
  return std::ranges::count(events, kind, &Event::kind);
}

TEST(EventLogTest, KeepsTheLatest) {
  EventLog log;
  for (int i = 0; i < 5000; ++i)
    log.add(EventKind::TaskState, "task", std::to_string(i));
  const auto events = all_of(log);
  EXPECT_EQ(events.size(), 4096U);
  EXPECT_EQ(events.back().number, 5000U);
  EXPECT_EQ(events.front().number, 905U);
}

TEST(EventLogTest, PropertiesThatAreSetOftenPushNothingElseOut) {
  EventLog log;
  log.add(EventKind::HostLost, "arm", "it does not answer");
  for (int i = 0; i < 3000; ++i) {
    log.add(EventKind::Property, "drive", "speed: " + std::to_string(i));
    if (i % 3 == 0) log.add(EventKind::TaskState, "drive", "running");
  }
  const auto events = all_of(log);
  EXPECT_EQ(count(events, EventKind::HostLost), 1);
  EXPECT_EQ(count(events, EventKind::TaskState), 1000);
  EXPECT_EQ(count(events, EventKind::Property), 1024);
  const auto oldest = std::ranges::find(events, EventKind::Property, &Event::kind);
  EXPECT_EQ(oldest->message, "speed: 1976");
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::number));
}

TEST(EventLogTest, WhatIsPushedOutLeavesRoomForProperties) {
  EventLog log;
  for (int i = 0; i < 1024; ++i)
    log.add(EventKind::Property, "drive", "before");
  for (int i = 0; i < 4096; ++i)
    log.add(EventKind::TaskState, "drive", "running");
  EXPECT_EQ(count(all_of(log), EventKind::Property), 0);
  for (int i = 0; i < 1024; ++i)
    log.add(EventKind::Property, "drive", "after");
  EXPECT_EQ(count(all_of(log), EventKind::Property), 1024);
}

}  // namespace
}  // namespace segue::runtime::detail
