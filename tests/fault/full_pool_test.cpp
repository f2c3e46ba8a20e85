// SPDX-License-Identifier: Apache-2.0
// A process whose pool of shared memory has no room left for another connection.
#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

class FullPool : public DeployedRobotTest {
 protected:
  void SetUp() override {
    DeployedRobotTest::SetUp();
    life_.reset();
    launch_.memory.prefault = std::size_t{1} << 16;
    launch_.memory.payload = std::size_t{1} << 24;
    begin_life();
  }
};

TEST_F(FullPool, RefusesAConnectionAndDisturbsNobody) {
  const auto plain = network("plain");
  const auto crowded = network("crowded", "  relay: {component: \"fault::Relay\", properties: {gain: 3}}\n",
                               "  work: {tasks: [relay]}\n",
                               "  - {from: beater.out, to: relay.in, policy: buffer, size: 1000000}\n");
  ASSERT_NO_FATAL_FAILURE(switch_to(plain));
  for (int i = 0; i < 3; ++i) {
    const auto refused = try_switch(crowded);
    ASSERT_EQ(refused.outcome, runtime::Outcome::Failed);
    EXPECT_EQ(refused.error->code, ErrorCode::ResourceExhausted) << to_string(*refused.error);
    expect_undisturbed();
    recover_to(plain);
    expect_undisturbed();
  }
}

}  // namespace
}  // namespace segue::testing
