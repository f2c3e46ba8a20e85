// SPDX-License-Identifier: Apache-2.0
// The Artemis rover, its processes dealt out to several hosts.
#include <segue/model/files.hpp>
#include <segue/runtime/temporary_hosts.hpp>

#include <support/shared_data.hpp>

#include <set>

#include "hosts_test.hpp"

namespace segue::testing {
namespace {

const std::vector<std::string> kControllers = {"search_explore", "goal_navigation", "manipulation",
                                               "manipulator_teleop"};
// An Eulerian circuit: every transition once, each starting where the last one ended.
const std::vector<std::string> kWalk = {
    "search_explore",     "goal_navigation",    "search_explore", "manipulation",    "search_explore",
    "manipulator_teleop", "goal_navigation",    "manipulation",   "goal_navigation", "manipulator_teleop",
    "manipulation",       "manipulator_teleop", "search_explore"};

class Artemis : public HostsTest {
 protected:
  /// Deals out the processes and writes the robot's files.
  void deal_out(const std::vector<std::string>& names) {
    make_hosts(names);
    write_robot("");
    std::set<std::string> used;
    for (const auto& controller : kControllers) {
      Diagnostics diagnostics;
      auto network = model::load_network(shared_data("artemis") / (controller + ".cnd"), diagnostics);
      ASSERT_TRUE(network) << to_string(diagnostics);
      runtime::deal_out(*network, names);
      for (const auto& deployment : network->deployments)
        used.insert(deployment.host.str());
      network->name = model::NetworkName(controller);
      write("robot/" + controller + ".net", model::write_network(*network));
    }
    ASSERT_EQ(used.size(), names.size()) << "every host has something to do";
  }

  void make_all_transitions() {
    start_robot({"--stand-in", "--controller", kWalk.front()});
    for (std::size_t i = 0; i < kWalk.size(); ++i) {
      SCOPED_TRACE(std::to_string(i) + ": to " + kWalk[i]);
      if (i > 0) switch_to(kWalk[i]);
      ASSERT_EQ(what_stays_wrong(network(kWalk[i])), "");
    }
    const auto before = all_deployments();
    switch_to(kWalk.back());
    EXPECT_EQ(all_deployments(), before) << "nothing is to be done";
    stop_robot();
    EXPECT_EQ(all_deployments(), (std::map<std::string, pid_t>{}));
  }

  static bool has_data() { return std::filesystem::exists(shared_data("artemis")); }
};

TEST_F(Artemis, makes_all_transitions_on_two_hosts) {
  if (!has_data()) GTEST_SKIP() << shared_data("artemis") << " is absent";
  deal_out({"a", "b"});
  make_all_transitions();
}

TEST_F(Artemis, makes_all_transitions_on_three_hosts) {
  if (!has_data()) GTEST_SKIP() << shared_data("artemis") << " is absent";
  deal_out({"a", "b", "c"});
  make_all_transitions();
}

}  // namespace
}  // namespace segue::testing
