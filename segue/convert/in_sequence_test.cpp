// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/in_sequence.hpp>
#include <segue/convert/test_support.hpp>

#include <gmock/gmock.h>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::VirtualRun;

std::vector<std::string> causes_of(const std::string& text) {
  const VirtualRun run(text);
  return why_in_sequence(run.plan(), run.order(), run.network_result());
}

TEST(InSequence, ActionsThatMayTouchAnythingAreNamed) {
  EXPECT_THAT(causes_of(R"x(
mission: m
actions:
  a: {run: {simulated: {duration: 1s}}}
  b: {sensing: true, run: {simulated: {duration: 1s}}}
  c: {effects: [+f], run: {simulated: {duration: 1s}}}
  d: {effects: [+g], reads_world: true, run: {simulated: {duration: 1s}}}
start: one
states:
  one: {action: a, on: {success: two}}
  two: {action: a, on: {success: three}}
  three: {action: b, on: {success: four}}
  four: {action: c, on: {success: five}}
  five: {action: d, on: {success: return success}}
)x"),
              ElementsAre("one and two run alone: they declare no facts and no resources, so they may touch "
                          "anything",
                          "three runs alone: it senses and declares no facts and no resources, so it may "
                          "rely on anything",
                          "five runs alone: it reads the whole world and is not pure"));
}

TEST(InSequence, AWatchThatReadsTheWorldIsNamedAsWhatMakesItsContainerRunAsWritten) {
  EXPECT_THAT(causes_of(R"x(
mission: m
actions:
  work: {effects: [+f], run: {simulated: {duration: 1s}}}
  watch: {pure: true, reads_world: true, run: {simulated: {duration: 5s}}}
start: guarded
states:
  guarded:
    kind: preemptive
    states:
      work: {on: {success: return success}}
      watch: {on: {success: return success}}
    on: {success: return success}
)x"),
              ElementsAre("guarded runs sequentially, since watch in it, concurrent with others, reads the "
                          "whole world"));
}

TEST(InSequence, NothingIsSaidWhereFactsAndDataDecide) {
  EXPECT_THAT(causes_of(R"x(
mission: m
actions:
  c: {effects: [+f], run: {simulated: {duration: 1s}}}
  d: {preconditions: [f], effects: [+g], run: {simulated: {duration: 1s}}}
start: one
states:
  one: {action: c, on: {success: two}}
  two: {action: d, on: {success: return success}}
)x"),
              IsEmpty());
}

TEST(InSequence, AStateThatIsDeclaredARoutineRunsAsOneAction) {
  const std::string text = R"x(
mission: m
actions:
  c: {effects: [+f], run: {simulated: {duration: 1s}}}
  d: {effects: [+g], run: {simulated: {duration: 1s}}}
start: both
states:
  both:
    start: one
    states:
      one: {action: c, on: {success: two}}
      two: {action: d, on: {success: return success}}
    on: {success: return success}
)x";
  EXPECT_EQ(VirtualRun(text).network_result().makespan, std::chrono::seconds(1));
  std::string routine = text;
  routine.replace(routine.find("    start: one"), 0, "    routine: true\n");
  EXPECT_EQ(VirtualRun(routine).network_result().makespan, std::chrono::seconds(2));
  EXPECT_THAT(causes_of(routine), ElementsAre("both runs sequentially, since it is declared a routine"));
}

TEST(InSequence, AnActionAloneInItsMissionWaitsForNobody) {
  EXPECT_THAT(causes_of(R"x(
mission: m
actions: {a: {run: {simulated: {duration: 1s}}}}
start: one
states: {one: {action: a, on: {success: return success}}}
)x"),
              IsEmpty());
}

TEST(InSequence, AnAbortThatIsHandledAtTheEndIsToldAsInARunAsWritten) {
  const VirtualRun run(R"x(
mission: m
actions: {a: {effects: [+f], run: {simulated: {duration: 1s, outcomes: [aborted], error: blocked}}}}
start: one
states: {one: {action: a, on: {success: return success, aborted: return success}}}
)x");
  EXPECT_EQ(run.result.outcome_name + ": " + run.result.error, "success: blocked");
}

}  // namespace
}  // namespace segue::convert
