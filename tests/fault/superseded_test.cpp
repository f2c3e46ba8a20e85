// SPDX-License-Identifier: Apache-2.0
// A request that supersedes another one uses what that has prepared.
#include <atomic>
#include <future>
#include <memory>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

using runtime::Outcome;

class Superseded : public DeployedRobotTest {
 protected:
  static std::string described(const runtime::SwitchResult& result) {
    return std::string(to_string(result.outcome)) + (result.ok() ? std::string() : ": " + result.why());
  }

  /// Requests l, and again while the action of that index is about to begin; how the first request must end
  /// follows from the phase of this action.
  void request_again_before(std::size_t index) {
    struct Held {
      std::atomic<std::size_t> begun{0};
      std::promise<model::Phase> reached;
      std::promise<void> go;
    };
    const auto held = std::make_shared<Held>();
    life_->asking().ask([held, index](const model::Action& action) -> Result<void> {
      if (held->begun++ != index) return {};
      held->reached.set_value(action.phase);
      held->go.get_future().wait();
      return {};
    });
    auto first = runtime().request(l_);
    auto phase = held->reached.get_future();
    ASSERT_EQ(phase.wait_for(kPatience), std::future_status::ready) << "the first has no such action";
    auto second = runtime().request(l_);
    held->go.set_value();
    const auto first_result = first.get();
    const auto second_result = second.get();
    life_->asking().ask(nullptr);
    const bool is_prepared = phase.get() == model::Phase::Prepare;
    EXPECT_EQ(first_result.outcome, is_prepared ? Outcome::Superseded : Outcome::Done)
        << described(first_result);
    EXPECT_EQ(second_result.outcome, Outcome::Done) << described(second_result);
    ++(is_prepared ? while_prepared_ : later_);
  }

  std::size_t while_prepared_ = 0;  ///< rounds in which the first request was superseded
  std::size_t later_ = 0;           ///< rounds in which it was behind its preparation, and completed

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

TEST_F(Superseded, RequestsNeverBlockAController) {
  switch_to(a_);
  const auto plan = runtime().plan(l_);
  ASSERT_TRUE(plan) << to_string(plan.error());
  for (std::size_t index = 0; index < plan->actions.size() && !HasFailure(); ++index) {
    SCOPED_TRACE("before action " + std::to_string(index) + " of " + std::to_string(plan->actions.size()));
    switch_to(a_);
    ASSERT_NO_FATAL_FAILURE(request_again_before(index));
    EXPECT_TRUE(equivalent(host().observe(), l_))
        << ::testing::PrintToString(differences(l_, host().observe()));
    expect_undisturbed();
  }
  EXPECT_GT(while_prepared_, 2U);
  EXPECT_GT(later_, 2U);
}

}  // namespace
}  // namespace segue::testing
