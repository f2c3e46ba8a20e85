// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "chain.hpp"

namespace segue::testing {

/// A robot as ChainTest makes it, that is disturbed in the midst of switches.
class DisturbedChainTest : public ChainTest {
 protected:
  using Disturb = std::function<void()>;
  static constexpr const char* kSlow = "100ms";

  /// Begins to switch, and disturbs the robot once that many actions are done. Returns the result, which is
  /// checked: it is done, or says why it is not, and what was undone.
  type::Value switch_disturbed(const std::string& controller, std::size_t actions, const Disturb& disturb);

  /// From `plain` to `more`, disturbed after each of `moments` (0: before the first action, 1: after the last
  /// one) in turn, then restored. `is_lost`: host b cannot be reached in between. Afterwards the robot runs
  /// what the result says, and can be switched.
  void disturb_switches(const std::vector<double>& moments, bool is_lost, const Disturb& disturb,
                        const Disturb& restore);
  /// Those moments of a switch, or one at each action if SEGUE_HOSTS_ALL_ACTIONS is set.
  static std::vector<double> moments(const std::vector<double>& some);
  static bool all_actions() { return std::getenv("SEGUE_HOSTS_ALL_ACTIONS") != nullptr; }

  /// The robot has been brought to what its controller says, and can be switched.
  void expect_whole(const std::string& controller);

 private:
  static constexpr int kMostRounds = 10;
  void disturb_one_switch(std::size_t at, bool is_lost, const Disturb& disturb, const Disturb& restore);

  bool was_in_time_ = false;  ///< the last disturbance came before the end of its switch
};

/// A text in a map; empty if it is not there.
std::string text_in(const type::Value& value, const char* key);

}  // namespace segue::testing
