// SPDX-License-Identifier: Apache-2.0
// A request that supersedes another one uses what that has prepared.
#include <chrono>
#include <thread>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

using runtime::Outcome;

class Superseded : public DeployedRobotTest {
 protected:
  static std::string described(const runtime::SwitchResult& result) {
    return std::string(to_string(result.outcome)) +
           (result.error ? ": " + to_string(*result.error) : std::string());
  }

  /// The consumer runs in process c, or in the runtime's own; l needs one process more.
  const model::Network a_ = network("a",
                                    "  relay: {component: \"fault::Relay\"}\n"
                                    "  consumer: {component: \"fault::Relay\"}\n",
                                    "  p: {tasks: [relay]}\n"
                                    "  c: {tasks: [consumer]}\n",
                                    "  - beater.out -> relay.in\n"
                                    "  - relay.out -> consumer.in\n");
  const model::Network l_ = network("l",
                                    "  relay: {component: \"fault::Relay\"}\n"
                                    "  consumer: {component: \"fault::Relay\"}\n"
                                    "  extra: {component: \"fault::Relay\"}\n",
                                    "  p: {tasks: [relay]}\n"
                                    "  q: {tasks: [extra]}\n",
                                    "  - beater.out -> relay.in\n"
                                    "  - relay.out -> consumer.in\n"
                                    "  - relay.out -> extra.in\n");
};

TEST_F(Superseded, requests_never_block_a_controller) {
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    switch_to(a_);
    auto first = runtime().request(l_);
    std::this_thread::sleep_for(std::chrono::milliseconds(3 * round));
    const auto second = runtime().switch_to(l_);
    ASSERT_EQ(second.outcome, Outcome::Done) << described(second);
    const Outcome outcome = first.get().outcome;
    EXPECT_TRUE(outcome == Outcome::Superseded || outcome == Outcome::Done);
    EXPECT_TRUE(equivalent(host().observe(), l_))
        << ::testing::PrintToString(differences(l_, host().observe()));
    expect_undisturbed();
  }
}

}  // namespace
}  // namespace segue::testing
