// SPDX-License-Identifier: Apache-2.0
#include "disturbed_chain.hpp"

#include <cmath>
#include <sstream>

namespace segue::testing {

using type::Value;

std::string text_in(const Value& value, const char* key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_string() ? std::string() : found->as_string();
}

namespace {

/// How far a transition has come.
struct SwitchProgress {
  std::size_t actions_done = 0;
  bool has_ended = false;

  /// `events`: what `segue events --follow` has said since before it, in JSON.
  static SwitchProgress of(const std::string& events) {
    SwitchProgress progress;
    std::istringstream lines(events);
    for (std::string line; std::getline(lines, line) && !lines.eof();) {  // the last one may be incomplete
      const std::string kind = text_in(type::parse_json(line).value_or(Value()), "kind");
      progress.actions_done += kind == "action_done" ? 1 : 0;
      progress.has_ended |= kind == "transition_done" || kind == "transition_failed";
    }
    return progress;
  }
};

}  // namespace

Value DisturbedChainTest::switch_disturbed(const std::string& controller, std::size_t actions,
                                           const Disturb& disturb) {
  const auto after = std::to_string(last_event());
  Process follower(command({"events", "--follow", "--after", after, "--format", "json"}), folder_);
  Process switcher(command({"switch", controller, "--format", "json"}), folder_);
  SwitchProgress progress;
  EXPECT_TRUE(follower.wait_until([&](const std::string& events) {
    progress = SwitchProgress::of(events);
    return progress.actions_done >= actions || progress.has_ended;
  }));
  disturb();
  was_in_time_ = !progress.has_ended;
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

void DisturbedChainTest::disturb_one_switch(std::size_t at, bool is_lost, const Disturb& disturb,
                                            const Disturb& restore) {
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

void DisturbedChainTest::disturb_switches(const std::vector<double>& moments, bool is_lost,
                                          const Disturb& disturb, const Disturb& restore) {
  const std::size_t actions = switch_to("more").find("actions")->as_list().size();
  switch_to("plain");
  bool any_amid = false;
  bool any_in_time = false;
  for (const double moment : moments) {
    const auto at = static_cast<std::size_t>(std::lround(moment * static_cast<double>(actions)));
    SCOPED_TRACE("after " + std::to_string(at) + " of " + std::to_string(actions) + " actions");
    const bool is_amid = at > 0 && 4 * at <= 3 * actions;  // a disturbance of the last actions may come late
    any_amid |= is_amid;
    // On a busy computer any one may; what it disturbs then is not a switch, so another one is.
    for (int round = 0; round == 0 || (is_amid && !any_in_time && round < kMostRounds); ++round) {
      ASSERT_NO_FATAL_FAILURE(disturb_one_switch(at, is_lost, disturb, restore));
      any_in_time |= is_amid && was_in_time_;
    }
  }
  EXPECT_EQ(any_in_time, any_amid) << "all switches had ended before they were disturbed";
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
