// SPDX-License-Identifier: Apache-2.0
// Component libraries that a deployment process cannot load.
#include <gmock/gmock.h>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

using runtime::Outcome;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class UnloadableLibrary : public DeployedRobotTest {
 protected:
  /// Makes new processes load this library as well.
  void install(const std::string& library) {
    life_.reset();
    launch_.libraries.push_back(library);
    begin_life();
  }
  /// The next process fails to start, reports why, and leaves nothing; the old network keeps running.
  void expect_refused(const std::string& words) {
    const auto more =
        network("more", "  extra: {component: \"fault::Relay\"}\n", "  late: {tasks: [extra]}\n");
    const auto result = try_switch(more);
    EXPECT_EQ(result.outcome, Outcome::Failed);
    ASSERT_TRUE(result.error);
    EXPECT_THAT(to_string(*result.error), HasSubstr(words));
    EXPECT_TRUE(eventually([&] { return pid_of("late") < 0; }));
    expect_undisturbed();
    switch_to(plain_);
    expect_undisturbed();
  }

  const model::Network plain_ = network("plain");
};

TEST_F(UnloadableLibrary, ThatIsNotInstalled) {
  switch_to(plain_);
  install("segue_test_nothing");
  expect_refused("segue_test_nothing");
}

TEST_F(UnloadableLibrary, ThatThrowsWhenItIsLoaded) {
  switch_to(plain_);
  install("segue_test_throws_at_load");
  expect_refused("thrown while the library was loaded");
}

}  // namespace
}  // namespace segue::testing
