// SPDX-License-Identifier: Apache-2.0
// Real samples between hosts, while the robot switches.
#include "chain.hpp"

namespace segue::testing {
namespace {

constexpr int kRounds = 5;

using SamplesBetweenHosts = ChainTest;

TEST_F(SamplesBetweenHosts, ArriveInOrderWithoutSwitches) {
  make_chain();
  start_chain("plain");
  expect_flow();
  expect_all_arrived();
}

TEST_F(SamplesBetweenHosts, ArriveInOrderWhileOthersComeAndGo) {
  make_chain();
  start_chain("plain");
  const auto before = all_deployments();
  for (int i = 0; i < kRounds; ++i) {
    switch_to("more");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
    expect_flow();
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  }
  EXPECT_EQ(all_deployments(), before);
  expect_all_arrived();
}

// Each connection between hosts has a sender and a receiver that find each other before the commit.
TEST_F(SamplesBetweenHosts, ArriveBesideSixtyOtherConnections) {
  make_chain();
  std::string connections;
  for (int i = 0; i < 60; ++i) {
    const std::string number = std::to_string(i);
    connections += i % 2 == 0 ? "  - here.out" + number + " -> there.in" + number + "\n"
                              : "  - there.out" + number + " -> here.in" + number + "\n";
  }
  add_to_chain("many", "  here: {component: \"x::Here\"}\n  there: {component: \"x::There\"}\n",
               "  left: {host: a, tasks: [here]}\n  right: {host: b, tasks: [there]}\n", connections);
  start_chain("plain");
  switch_to("many");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("many")), "");
  expect_flow();
  switch_to("plain");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  expect_all_arrived();
}

// A relay that is removed takes with it what it has not passed on yet. The consumer counts that. Order is
// promised for each connection, and the consumer gets another one.
TEST_F(SamplesBetweenHosts, ArriveOnceAlthoughTheRelayIsExchanged) {
  make_chain();
  start_chain("plain");
  wait_for_more();
  for (int i = 0; i < kRounds; ++i) {
    SCOPED_TRACE(i);
    switch_to("other");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("other")), "");
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  }
  wait_for_more();
  const std::uint64_t lost = expect_each_once();
  EXPECT_LT(lost, updates("producer") / 2);
}

}  // namespace
}  // namespace segue::testing
