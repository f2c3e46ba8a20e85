// SPDX-License-Identifier: Apache-2.0
// A robot on a network that loses, delays, reorders and duplicates frames, or is cut in one direction or
// both.
#include <random>

#include "network_test.hpp"

namespace segue::testing {
namespace {

const std::vector<std::string> kImpairments = {
    "loss 10%",      "delay 5ms jitter 5ms loss 5% duplicate 5% reorder 10% 10ms",
    "delay 20ms",    "delay 1ms jitter 5ms",
    "duplicate 20%", "reorder 25% 3ms",
};

class ImpairedNetwork : public NetworkTest {
 protected:
  /// Cut as `cut` says in the midst of switches.
  void cut_in_switches(const std::string& cut, const std::vector<double>& some, bool is_lost) {
    make_chain({}, kSlow);
    start_chain("plain");
    disturb_switches(
        moments(some), is_lost, [&] { say(cut); }, [&] { say("heal"); });
    expect_all_accounted_for();
  }
};

TEST_F(ImpairedNetwork, CarriesSamplesAndSwitchesWhateverBefallsFrames) {
  make_chain();
  start_chain("plain");
  const std::size_t count = all_actions() ? kImpairments.size() : 2;
  for (std::size_t i = 0; i < count; ++i) {
    SCOPED_TRACE(kImpairments[i]);
    say(kImpairments[i]);
    for (const char* controller : {"more", "plain"})
      try_switch(controller);
    wait_for_more();
    say("clear");
    ASSERT_TRUE(recover_to("plain"));
    expect_whole("plain");
  }
  expect_all_accounted_for();
}

TEST_F(ImpairedNetwork, CutsAHostOffInSwitches) {
  cut_in_switches("cut b<>*", {0.5}, true);
}

TEST_F(ImpairedNetwork, LosesWhatAHostSendsInSwitches) {
  cut_in_switches("cut b>*", {0.9}, true);
}

TEST_F(ImpairedNetwork, LosesWhatIsSentToAHostInSwitches) {
  cut_in_switches("cut *>b", {0.7}, true);
}

// The runtime reaches both.
TEST_F(ImpairedNetwork, LosesSamplesInOneDirectionInSwitches) {
  cut_in_switches("cut a>b", {0}, false);
}

TEST_F(ImpairedNetwork, ChangesAllTheTimeWhileTheRobotSwitches) {
  make_chain();
  start_chain("plain");
  const auto seed = static_cast<unsigned>(::getpid());
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto any_of = [&](const auto& list) { return list[random() % list.size()]; };
  const std::vector<std::string> cuts = {"cut b<>*", "cut a>b", "cut *>b", "cut a<>runtime", "heal"};
  const std::vector<std::string> controllers = {"plain", "more", "other"};
  for (int i = 0; i < (all_actions() ? 60 : 2); ++i) {
    const auto before = any_of(kImpairments);
    const auto amid = any_of(cuts);
    const auto wanted = any_of(controllers);
    SCOPED_TRACE(wanted + " with " + before + ", " + amid);
    say(before);
    switch_disturbed(wanted, random() % 20, [&] { say(amid); });
    say("clear");
    ASSERT_TRUE(wait_until_reachable("a", true));
    ASSERT_TRUE(wait_until_reachable("b", true));
    const auto runs = text_in(status(), "controller");
    ASSERT_EQ(what_stays_wrong(HostsTest::network(runs)), "");
  }
  ASSERT_TRUE(recover_to("plain"));
  expect_whole("plain");
  expect_each_once();
}

}  // namespace
}  // namespace segue::testing
