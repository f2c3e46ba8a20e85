// SPDX-License-Identifier: Apache-2.0
// What happens when a host dies, stands still, or loses its daemon: before, in and after a switch.
#include <functional>

#include "disturbed_chain.hpp"

namespace segue::testing {
namespace {

using type::Value;

class LostHost : public DisturbedChainTest {
 protected:
  void lose(const std::function<void()>& how) {
    const auto before = last_event();
    how();
    ASSERT_TRUE(wait_until_reachable("b", false));
    expect_event("host_lost", "b:", before);
  }
  void find(const std::function<void()>& how) {
    const auto before = last_event();
    how();
    ASSERT_TRUE(wait_until_reachable("b", true));
    expect_event("host_found", "b:", before);
  }

  /// The status names the host, and what is known of it is marked as unknown.
  void expect_unknown() {
    const auto now = status();
    for (const Value& task : now.find("tasks")->as_list()) {
      const bool is_there = text_in(task, "host") == "b";
      EXPECT_EQ(*task.find("unknown"), Value(is_there)) << type::to_json(task);
      EXPECT_EQ(text_in(task, "error").find("host 'b'") != std::string::npos, is_there)
          << type::to_json(task);
    }
  }

  /// Refused, with a message that names the host, and nothing has changed on the other one.
  void expect_refused(const std::string& controller) {
    SCOPED_TRACE(controller);
    const auto before = host("a").deployments();
    const auto result = switch_to(controller, "refused");
    EXPECT_NE(text_in(result, "error").find("host 'b'"), std::string::npos) << type::to_json(result);
    EXPECT_NE(text_in(result, "error").find("nothing has changed"), std::string::npos)
        << type::to_json(result);
    EXPECT_TRUE(result.find("actions")->as_list().empty());
    EXPECT_EQ(host("a").deployments(), before);
    EXPECT_EQ(text_in(status(), "controller"), "plain");
  }

  /// Disturbed at some moments of a switch.
  void lose_in_switches(const Disturb& disturb, const Disturb& restore) {
    make_chain({}, kSlow);
    start_chain("plain");
    disturb_switches(moments({0, 0.25, 0.5, 0.75, 1}), true, disturb, restore);
  }
};

TEST_F(LostHost, IsKilledBetweenSwitches) {
  make_chain();
  start_chain("plain");
  lose([&] { host("b").kill(); });
  expect_unknown();
  expect_refused("more");
  expect_refused("near");
  find([&] { host("b").start(); });
  expect_whole("plain");
}

TEST_F(LostHost, IsNotNeededWhereItIsOptional) {
  make_chain({"b"});
  start_chain("more");
  const pid_t front = host("a").deployments().at("front");
  lose([&] { host("b").kill(); });
  expect_unknown();
  for (const std::string controller : {"plain", "more", "near"}) {
    switch_to(controller);
    EXPECT_EQ(host("a").deployments().at("front"), front);
    EXPECT_EQ(host("a").deployments().contains("left"), controller == "more");
  }
  wait_for_more();
  switch_to("plain");
  find([&] { host("b").start(); });
  expect_whole("plain");
  EXPECT_EQ(host("a").deployments().at("front"), front);
}

TEST_F(LostHost, IsKilledInSwitches) {
  lose_in_switches([&] { host("b").kill(); }, [&] { host("b").start(); });
}

TEST_F(LostHost, StandsStillBetweenSwitches) {
  make_chain();
  start_chain("plain");
  const auto before = all_deployments();
  lose([&] { host("b").freeze(); });
  expect_unknown();
  expect_refused("more");
  find([&] { host("b").thaw(); });
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  EXPECT_EQ(all_deployments(), before);
  expect_whole("plain");
}

TEST_F(LostHost, StandsStillInSwitches) {
  lose_in_switches([&] { host("b").freeze(); }, [&] { host("b").thaw(); });
}

TEST_F(LostHost, LosesItsDaemonAndSamplesFlowOn) {
  make_chain();
  start_chain("plain");
  expect_flow();
  const auto before = all_deployments();
  for (const std::string victim : {"b", "a"}) {
    SCOPED_TRACE(victim);
    host(victim).kill_daemon();
    ASSERT_TRUE(wait_until_reachable(victim, false));
    EXPECT_EQ(all_deployments(), before);
    switch_to("more", "refused");
    host(victim).start();
    ASSERT_TRUE(wait_until_reachable(victim, true));
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    EXPECT_EQ(all_deployments(), before);
    expect_flow();
    switch_to("more");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  }
  EXPECT_EQ(all_deployments(), before);
  expect_all_arrived();
}

}  // namespace
}  // namespace segue::testing
