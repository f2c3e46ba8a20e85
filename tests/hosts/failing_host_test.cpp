// SPDX-License-Identifier: Apache-2.0
// Hosts that lose their power and start again, whose disk is full, or whose clock is set.
#include <support/eventually.hpp>

#include "../fault/processes.hpp"
#include "network_test.hpp"

namespace segue::testing {
namespace {

using type::Value;

constexpr int kHour = 3600;
constexpr std::uint64_t kMany = 4000;

class FailingHost : public NetworkTest {
 protected:
  /// As if the power failed: nobody is told that its connections have ended. Then it starts again.
  void cycle_power() {
    say("cut b<>*");
    host("b").kill();
    say("heal");
    host("b").reboot();
  }

  double clock_offset_s(const std::string& name) {
    const Value status = host_status(name);
    const Value* offset = status.find("clock_offset_us");
    return offset == nullptr || !offset->is_number() ? 0 : offset->as_double() / 1e6;
  }
  /// Sets the clocks of some stations, by seconds, and waits until the runtime has seen it.
  void set_clocks(const std::map<std::string, int>& clocks) {
    for (const auto& [station, seconds] : clocks)
      set_clock(station, seconds);
    const auto is_near = [&](const std::string& name) {
      const double expected = clocks.at(name) - clocks.at("runtime");
      return std::abs(clock_offset_s(name) - expected) < 60;
    };
    EXPECT_TRUE(eventually([&] { return is_near("a") && is_near("b"); })) << segue({"status"}).output;
  }
};

TEST_F(FailingHost, StartsAgainInSwitches) {
  make_chain({}, kSlow);
  start_chain("plain");
  disturb_switches(
      moments({0.2, 0.9}), false, [&] { cycle_power(); }, [] {});
  expect_each_once_and_in_order();
}

TEST_F(FailingHost, HasAFullDiskInSwitches) {
  give_b_a_disk();
  make_chain({}, kSlow);
  start_chain("plain");
  fill_disk();
  const auto result = switch_disturbed("more", 0, [] {});
  EXPECT_EQ(text_in(result, "outcome"), "failed");
  EXPECT_NE(text_in(result, "error").find("No space left on device"), std::string::npos)
      << type::to_json(result);
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  wait_for_more();
  empty_disk();
  disturb_switches(
      moments({0.5}), false, [&] { fill_disk(); }, [&] { empty_disk(); });
  expect_all_accounted_for();
}

TEST_F(FailingHost, HasAFullDiskWhenARuntimeComes) {
  give_b_a_disk();
  make_chain();
  start_chain("plain");
  const auto before = all_deployments();
  kill_runtime();
  fill_disk();
  start_chain("");  // the daemon cannot keep the new epoch, so it does not obey
  EXPECT_TRUE(eventually([&] {
    return text_in(host_status("b"), "state").find("No space left on device") != std::string::npos;
  })) << segue({"status"}).output;
  ASSERT_TRUE(wait_until_reachable("a", true)) << "a busy computer may take a while";
  EXPECT_NE(text_in(switch_to("more", "refused"), "error").find("host 'b'"), std::string::npos);
  EXPECT_EQ(all_deployments(), before);
  empty_disk();
  ASSERT_TRUE(wait_until_reachable("a", true));
  ASSERT_TRUE(wait_until_reachable("b", true));
  // The new runtime knows of no controller, so it may have begun to remove what it found on b.
  switch_to("plain");
  expect_whole("plain");
}

// A wall clock that is set back is the worst: who waits for a time of that clock waits for that much longer.
// Cyclone DDS did.
TEST_F(FailingHost, HasAClockThatJumps) {
  give_clocks();
  make_chain({}, kSlow);
  start_chain("plain");
  const std::map<std::string, int> none = {{"a", 0}, {"b", 0}, {"runtime", 0}};
  std::vector<std::map<std::string, int>> jumps;
  for (const char* station : all_actions() ? std::vector{"b", "a", "runtime"} : std::vector{"b"}) {
    for (const int seconds : all_actions() ? std::vector{-kHour, kHour} : std::vector{kHour}) {
      jumps.push_back(none);
      jumps.back()[station] = seconds;
    }
  }
  jumps.push_back(none);
  for (const auto& clocks : jumps) {
    const auto result = switch_disturbed("more", 10, [&] { set_clocks(clocks); });
    EXPECT_EQ(text_in(result, "outcome"), "done") << type::to_json(result);
    switch_to("plain");
  }
  set_clocks({{"a", -kHour}, {"b", -kHour}, {"runtime", 0}});
  auto list = runtime_launcher();
  for (auto& word : command({"host", "list", "robot/robot.yaml", "--format", "json"}))
    list.push_back(std::move(word));
  const auto listed = run(list, folder_);
  const auto hosts = type::parse_json(listed.output);
  ASSERT_TRUE(hosts) << listed.output << listed.errors;
  for (const auto& host : hosts->as_list())
    EXPECT_NEAR(host.find("clock_offset_s")->as_double(), -kHour, 60) << listed.output;
  // More than signs of life that are overdue would allow.
  const auto before = counted();
  EXPECT_TRUE(eventually([&] { return counted().count > before.count + kMany; })) << counted().count;
  expect_whole("plain");
  expect_all_arrived();
}

}  // namespace
}  // namespace segue::testing
