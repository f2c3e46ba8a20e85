// SPDX-License-Identifier: Apache-2.0
// What happens when a host dies, stands still, or loses its daemon: before, in and after a switch.
#include <cstdlib>
#include <functional>

#include "../fault/robot_checks.hpp"
#include "chain.hpp"

namespace segue::testing {
namespace {

using type::Value;

constexpr const char* kSlow = "20ms";

std::string text(const Value& value, const char* key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_string() ? std::string() : found->as_string();
}

class LostHost : public ChainTest {
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
      const bool is_there = text(task, "host") == "b";
      EXPECT_EQ(*task.find("unknown"), Value(is_there)) << type::to_json(task);
      EXPECT_EQ(text(task, "error").find("host 'b'") != std::string::npos, is_there) << type::to_json(task);
    }
  }

  /// Refused, with a message that names the host, and nothing has changed on the other one.
  void expect_refused(const std::string& controller) {
    SCOPED_TRACE(controller);
    const auto before = host("a").deployments();
    const auto result = switch_to(controller, "refused");
    EXPECT_NE(text(result, "error").find("host 'b'"), std::string::npos) << type::to_json(result);
    EXPECT_NE(text(result, "error").find("nothing has changed"), std::string::npos) << type::to_json(result);
    EXPECT_TRUE(result.find("actions")->as_list().empty());
    EXPECT_EQ(host("a").deployments(), before);
    EXPECT_EQ(text(status(), "controller"), "plain");
  }

  /// The robot has been brought to what its controller says, and can be switched.
  void expect_whole(const std::string& controller) {
    EXPECT_EQ(what_stays_wrong(HostsTest::network(controller)), "");
    wait_for_more();
    switch_to("more");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    wait_for_more();
  }

  /// Begins to switch, and disturbs the robot once that many actions are done. Returns the result.
  Value switch_disturbed(const std::string& controller, std::size_t actions,
                         const std::function<void()>& disturb) {
    const auto after = last_event();
    Process switcher(command({"switch", controller, "--format", "json"}), folder_);
    EXPECT_TRUE(eventually([&] { return actions_done(after) >= actions || has_ended(after); }));
    disturb();
    const auto finished = switcher.wait();
    EXPECT_TRUE(finished.status == 0 || finished.status == 1) << finished.status << finished.errors;
    return type::parse_json(finished.output).value_or(Value());
  }

  /// The actions at which a switch is disturbed: some, or all if SEGUE_HOSTS_ALL_ACTIONS is set.
  std::vector<std::size_t> samples(std::size_t actions) {
    std::vector<std::size_t> chosen;
    const std::size_t step = std::getenv("SEGUE_HOSTS_ALL_ACTIONS") != nullptr ? 1 : actions / 4;
    for (std::size_t at = 0; at <= actions; at += step)
      chosen.push_back(at);
    return chosen;
  }

  void disturb_switches(const std::function<void()>& disturb, const std::function<void()>& restore) {
    make_chain({}, kSlow);
    start_chain("plain");
    const std::size_t actions = switch_to("more").find("actions")->as_list().size();
    switch_to("plain");
    for (const std::size_t at : samples(actions)) {
      SCOPED_TRACE("after " + std::to_string(at) + " of " + std::to_string(actions) + " actions");
      const auto result = switch_disturbed("more", at, disturb);
      const std::string outcome = text(result, "outcome");
      EXPECT_TRUE(outcome == "done" || outcome == "failed" || outcome == "refused") << type::to_json(result);
      if (outcome == "failed") {
        EXPECT_NE(text(result, "error"), "");
        EXPECT_NE(result.find("undo"), nullptr) << type::to_json(result);
      }
      ASSERT_TRUE(wait_until_reachable("b", false));
      restore();
      ASSERT_TRUE(wait_until_reachable("b", true));
      const std::string runs = text(status(), "controller");
      EXPECT_EQ(runs, outcome == "done" ? "more" : "plain") << type::to_json(result);
      EXPECT_EQ(what_stays_wrong(HostsTest::network(runs)), "") << type::to_json(result);
      wait_for_more();
      ASSERT_TRUE(recover_to("plain"));
    }
  }

 private:
  std::size_t actions_done(std::int64_t after) {
    std::size_t count = 0;
    const auto events = json({"events", "--after", std::to_string(after)});
    for (const Value& event : events.as_list())
      count += text(event, "kind") == "action_done" ? 1 : 0;
    return count;
  }
  bool has_ended(std::int64_t after) {
    const auto events = json({"events", "--after", std::to_string(after)});
    return std::any_of(events.as_list().begin(), events.as_list().end(), [](const Value& event) {
      return text(event, "kind") == "transition_done" || text(event, "kind") == "transition_failed";
    });
  }
};

TEST_F(LostHost, is_killed_between_switches) {
  make_chain();
  start_chain("plain");
  lose([&] { host("b").kill(); });
  expect_unknown();
  expect_refused("more");
  expect_refused("near");
  find([&] { host("b").start(); });
  expect_whole("plain");
}

TEST_F(LostHost, is_not_needed_where_it_is_optional) {
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

TEST_F(LostHost, is_killed_in_switches) {
  disturb_switches([&] { host("b").kill(); }, [&] { host("b").start(); });
}

TEST_F(LostHost, stands_still_between_switches) {
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

TEST_F(LostHost, stands_still_in_switches) {
  disturb_switches([&] { host("b").freeze(); }, [&] { host("b").thaw(); });
}

TEST_F(LostHost, loses_its_daemon_and_samples_flow_on) {
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
