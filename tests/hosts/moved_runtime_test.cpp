// SPDX-License-Identifier: Apache-2.0
// The runtime is started on another computer, or with one more host, while the robot's tasks run on. What
// they exchange between hosts goes on, and new connections between hosts can be made.
#include <support/eventually.hpp>

#include "network_test.hpp"

namespace segue::testing {
namespace {

class MovedRuntime : public NetworkTest {
 protected:
  [[nodiscard]] std::vector<std::string> runtime_launcher() const override {
    return TestNetwork::launcher(station_);
  }

  void run_plain() {
    make_chain();
    start_chain("plain");
    expect_flow();
    before_ = all_deployments();
    kill_runtime();
  }
  /// The controller has connections between hosts that were not there before.
  void expect_switch_to(const std::string& controller) {
    start_chain("");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    switch_to(controller);
    EXPECT_EQ(what_stays_wrong(HostsTest::network(controller)), "");
  }
  /// All processes of the beginning are there, and no sample was lost.
  void expect_undisturbed() {
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    EXPECT_EQ(all_deployments(), before_);
    expect_all_arrived();
  }

  std::string station_ = "runtime";
  std::map<std::string, pid_t> before_;
};

TEST_F(MovedRuntime, ConnectsHostsFromAnotherComputer) {
  run_plain();
  station_ = "c";
  expect_switch_to("more");
  expect_undisturbed();
}

TEST_F(MovedRuntime, ConnectsHostsWithItsNewComputer) {
  run_plain();
  add_to_chain("here", "  mirror: {component: \"bench::Relay\"}\n  end: {component: \"bench::Consumer\"}\n",
               "  near: {tasks: [mirror]}\n  far: {host: b, tasks: [end]}\n",
               "  - {from: relay.out, to: mirror.in, policy: buffer, size: 10000}\n"
               "  - {from: mirror.out, to: end.in, policy: buffer, size: 10000}\n");
  station_ = "c";
  expect_switch_to("here");
  EXPECT_TRUE(eventually([&] { return counted("end").count > 20; }));
  expect_undisturbed();
}

TEST_F(MovedRuntime, ConnectsAHostThatWasAdded) {
  run_plain();
  make_hosts({"c"});
  write_robot("libraries: [segue_components_bench]\n");
  add_to_chain("wide", "  end: {component: \"bench::Consumer\"}\n", "  far: {host: c, tasks: [end]}\n",
               "  - {from: relay.out, to: end.in, policy: buffer, size: 10000}\n");
  expect_switch_to("wide");
  EXPECT_TRUE(eventually([&] { return counted("end").count > 20; }));
  expect_undisturbed();
}

}  // namespace
}  // namespace segue::testing
