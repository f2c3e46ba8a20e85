// SPDX-License-Identifier: Apache-2.0
#include "disturbed_chain.hpp"

#include <algorithm>
#include <cmath>

#include "../fault/robot_checks.hpp"

namespace segue::testing {

using type::Value;

std::string text_in(const Value& value, const char* key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_string() ? std::string() : found->as_string();
}

std::size_t DisturbedChainTest::actions_done(std::int64_t after) {
  std::size_t count = 0;
  const auto events = json({"events", "--after", std::to_string(after)});
  for (const Value& event : events.as_list())
    count += text_in(event, "kind") == "action_done" ? 1 : 0;
  return count;
}

bool DisturbedChainTest::has_ended(std::int64_t after) {
  const auto events = json({"events", "--after", std::to_string(after)});
  return std::any_of(events.as_list().begin(), events.as_list().end(), [](const Value& event) {
    return text_in(event, "kind") == "transition_done" || text_in(event, "kind") == "transition_failed";
  });
}

Value DisturbedChainTest::switch_disturbed(const std::string& controller, std::size_t actions,
                                           const Disturb& disturb) {
  const auto after = last_event();
  Process switcher(command({"switch", controller, "--format", "json"}), folder_);
  EXPECT_TRUE(eventually([&] { return actions_done(after) >= actions || has_ended(after); }));
  disturb();
  const auto finished = switcher.wait();
  EXPECT_TRUE(finished.status == 0 || finished.status == 1) << finished.status << finished.errors;
  const auto result = type::parse_json(finished.output).value_or(Value());
  const std::string outcome = text_in(result, "outcome");
  EXPECT_TRUE(outcome == "done" || outcome == "failed" || outcome == "refused") << type::to_json(result);
  if (outcome != "done") {
    EXPECT_NE(text_in(result, "error"), "") << type::to_json(result);
  }
  if (outcome == "failed") {
    EXPECT_NE(result.find("undo"), nullptr) << type::to_json(result);
  }
  return result;
}

std::vector<double> DisturbedChainTest::moments(const std::vector<double>& some) {
  if (!all_actions()) return some;
  constexpr int kActions = 35;  // of a switch to `more`
  std::vector<double> all;
  for (int i = 0; i <= kActions; ++i)
    all.push_back(static_cast<double>(i) / kActions);
  return all;
}

void DisturbedChainTest::disturb_switches(const std::vector<double>& moments, bool is_lost,
                                          const Disturb& disturb, const Disturb& restore) {
  const std::size_t actions = switch_to("more").find("actions")->as_list().size();
  switch_to("plain");
  for (const double moment : moments) {
    const auto at = static_cast<std::size_t>(std::lround(moment * static_cast<double>(actions)));
    SCOPED_TRACE("after " + std::to_string(at) + " of " + std::to_string(actions) + " actions");
    const auto result = switch_disturbed("more", at, disturb);
    if (is_lost) {
      ASSERT_TRUE(wait_until_reachable("b", false));
    }
    restore();
    ASSERT_TRUE(wait_until_reachable("b", true));
    const std::string runs = text_in(status(), "controller");
    EXPECT_EQ(runs, text_in(result, "outcome") == "done" ? "more" : "plain") << type::to_json(result);
    EXPECT_EQ(what_stays_wrong(HostsTest::network(runs)), "") << type::to_json(result);
    wait_for_more();
    ASSERT_TRUE(recover_to("plain"));
  }
}

void DisturbedChainTest::expect_whole(const std::string& controller) {
  EXPECT_EQ(what_stays_wrong(HostsTest::network(controller)), "");
  wait_for_more();
  switch_to("more");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
  switch_to("plain");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  wait_for_more();
}

}  // namespace segue::testing
