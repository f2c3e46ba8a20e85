// SPDX-License-Identifier: Apache-2.0
// Connections between tasks that stay are exchanged again and again, among processes that come and go.
#include <random>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

class ExchangedConnections : public DeployedRobotTest {
 protected:
  /// `far` and `near` hear `quick` in any case, through buffers of random sizes, which hold the beats of
  /// some seconds. Guests are there by chance.
  model::Network random_network() {
    std::string tasks =
        "  quick: {component: \"fault::Beater\", activity: {periodic: 500us}}\n"
        "  far: {component: \"fault::Watcher\"}\n  near: {component: \"fault::Watcher\"}\n";
    std::string deployments = "  p: {tasks: [far]}\n  q: {tasks: [quick]}\n";
    std::string connections = heard_by("far") + heard_by("near");
    for (const std::string guest : {"one", "two"}) {
      if (pick(2) == 0) continue;
      tasks += "  " + guest + ": {component: \"fault::Watcher\"}\n";
      if (pick(2) == 0) deployments += "  " + guest + "_process: {tasks: [" + guest + "]}\n";
      connections += heard_by(guest);
    }
    return network("random", tasks, deployments, connections);
  }

 private:
  unsigned pick(unsigned count) { return static_cast<unsigned>(random_()) % count; }
  std::string heard_by(const std::string& task) {
    const std::string size = std::to_string(8000 + pick(3));
    return "  - {from: quick.out, to: " + task + ".in, policy: buffer, size: " + size + "}\n";
  }

  std::minstd_rand random_{20261124};
};

TEST_F(ExchangedConnections, LoseAndDoubleNothingAndKeepTheOrder) {
  for (int i = 0; i < number_of_switches(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(switch_to(random_network()));
  }
  for (const char* watcher : {"far", "near", "watcher", "witness"})
    expect_undisturbed(watcher);
}

}  // namespace
}  // namespace segue::testing
