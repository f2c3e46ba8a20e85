// SPDX-License-Identifier: Apache-2.0
#include "disturbed_transition.hpp"

#include <segue/model/network_sets.hpp>

#include <atomic>

namespace segue::testing {

using runtime::Outcome;

void DisturbedTransition::before_every_action(const std::string& what, const Disturb& disturb,
                                              const Restore& restore, Duration action_deadline) {
  std::size_t actions = 1;
  for (std::size_t i = 0; i < actions; ++i) {
    SCOPED_TRACE(what + " before action " + std::to_string(i));
    recover_to(one_);
    const auto plan = runtime().plan(two_);
    ASSERT_TRUE(plan) << to_string(plan.error());
    actions = plan->actions.size();
    std::atomic<std::size_t> begun{0};
    life_->asking().ask([&](const model::Action&) -> Result<void> {
      if (begun++ == i) disturb(i);
      return {};
    });
    const auto result = try_switch(two_, action_deadline);
    life_->asking().ask(nullptr);
    expect_no_secret_mixture(result);
    if (restore) restore();
    recover_to(two_);
  }
  EXPECT_GT(actions, 10U);
}

void DisturbedTransition::expect_no_secret_mixture(const runtime::SwitchResult& result) {
  const auto observed = host().observe();
  const bool done = result.outcome == Outcome::Done;
  const bool restored = result.undo && result.undo->restored;
  const auto& claimed = done ? two_ : one_;
  // Parts that could not be retired and leftovers of an attempt are additional.
  const bool may_have_more = result.leftover || restored;
  const bool runs = may_have_more ? model::includes(observed, claimed) : equivalent(observed, claimed);
  if ((done || restored) && runs) return;
  const bool reported =
      !runtime().observed_differences().empty() || runtime().state() == runtime::RuntimeState::Failed;
  EXPECT_TRUE(reported) << to_string(result.outcome) << result.why() << '\n'
                        << ::testing::PrintToString(differences(claimed, observed));
}

}  // namespace segue::testing
