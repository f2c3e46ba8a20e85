// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/files.hpp>
#include <segue/runtime/temporary_hosts.hpp>

#include <support/paths.hpp>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hosts_test.hpp"

/// The Artemis rover, its processes dealt out to several hosts.
namespace segue::testing {

inline const std::vector<std::string> kArtemisControllers = {"search_explore", "goal_navigation",
                                                             "manipulation", "manipulator_teleop"};
// An Eulerian circuit: every transition once, each starting where the last one ended.
inline const std::vector<std::string> kArtemisWalk = {
    "search_explore",     "goal_navigation",    "search_explore", "manipulation",    "search_explore",
    "manipulator_teleop", "goal_navigation",    "manipulation",   "goal_navigation", "manipulator_teleop",
    "manipulation",       "manipulator_teleop", "search_explore"};

/// On the hosts of a HostsTest.
template <class Base>
class ArtemisTest : public Base {
 protected:
  /// Deals out the processes and writes the robot's files.
  void deal_out(const std::vector<std::string>& names) {
    this->make_hosts(names);
    this->write_robot("");
    std::set<std::string> used;
    for (const auto& controller : kArtemisControllers) {
      Diagnostics diagnostics;
      const auto file = segue::paths::in_sources("/examples/04_artemis/controllers/") + controller + ".cnd";
      auto network = model::load_network(file, diagnostics);
      ASSERT_TRUE(network) << to_string(diagnostics);
      runtime::deal_out(*network, names);
      for (const auto& deployment : network->deployments)
        used.insert(deployment.host.str());
      network->name = model::NetworkName(controller);
      this->write("robot/" + controller + ".net", model::write_network(*network));
    }
    ASSERT_EQ(used.size(), names.size()) << "every host has something to do";
  }

  void make_all_transitions() {
    this->start_robot({"--stand-in", "--controller", kArtemisWalk.front()});
    for (std::size_t i = 0; i < kArtemisWalk.size(); ++i) {
      SCOPED_TRACE(std::to_string(i) + ": to " + kArtemisWalk[i]);
      if (i > 0) this->switch_to(kArtemisWalk[i]);
      ASSERT_EQ(this->what_stays_wrong(this->network(kArtemisWalk[i])), "");
    }
    const auto before = this->all_deployments();
    this->switch_to(kArtemisWalk.back());
    EXPECT_EQ(this->all_deployments(), before) << "nothing is to be done";
    this->stop_robot();
    EXPECT_EQ(this->all_deployments(), (std::map<std::string, pid_t>{}));
  }
};

}  // namespace segue::testing
