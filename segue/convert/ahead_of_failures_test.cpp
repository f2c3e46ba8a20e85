// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/convert/test_support.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

/// The list, known before a run, of states that may act although an earlier one fails.
namespace segue::convert {
namespace {

using ::testing::ElementsAre;

/// Of a mission that unlocks the door in the beginning or does not, then unlocks it twice.
std::string unlocks(const std::string& in_between = "") {
  return R"(
mission: twice
actions:
  look:
    outcomes: [locked, open]
    pure: true
    run: {simulated: {outcomes: [locked]}}
  unlock:
    effects: [+unlocked]
    run: {simulated: {duration: 1s}}
  lock:
    effects: [-unlocked]
    run: {simulated: {duration: 1s}}
outcomes: [done]
start: look
states:
  look:
    action: look
    on: {locked: unlock, open: again}
  unlock:
    action: unlock
    on: {success: again}
)" + in_between +
         R"(
  again:
    action: unlock
    on: {success: enter}
  enter:
    action: unlock
    on: {success: return done}
)";
}

std::vector<std::string> fails_before(const std::string& text, const std::string& acts) {
  const auto pairs = ahead_of_failures(testing::program(text)).value().pairs;
  const auto found = std::ranges::find(pairs, acts, &task_network::NamedActsAhead::acts);
  return found == pairs.end() ? std::vector<std::string>() : found->fails;
}

TEST(AheadOfFailures, WhoFindsAFactAsItMakesItMayNotWaitForOthersThatMakeIt) {
  // Where the door has been unlocked in the beginning, neither of the others changes anything. It waits for
  // that, but not for what is decided about it, since it comes next in any case.
  EXPECT_THAT(fails_before(unlocks(), "enter"), ElementsAre("look", "again"));
}

TEST(AheadOfFailures, WhoChangesAFactOnEveryPathIsWaitedFor) {
  std::string text = unlocks(R"(
  lock:
    action: lock
    on: {success: again}
)");
  for (const std::string to : {"open: again", "success: again"})
    text.replace(text.find(to), to.size(), to.substr(0, to.find(':')) + ": lock");
  EXPECT_THAT(fails_before(text, "enter"), ElementsAre("look"));
}

}  // namespace
}  // namespace segue::convert
