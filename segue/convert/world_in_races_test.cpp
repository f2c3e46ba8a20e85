// SPDX-License-Identifier: Apache-2.0
//
// Preemptive containers of which a state looks at all facts.
#include <segue/convert/test_support.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::convert {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

using testing::VirtualRun;

/// Takes a second, and keeps what facts it saw each time.
class PlansFromFacts final : public mission::ActionRunner {
 public:
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    const auto world = call.world();
    seen.emplace_back(world->facts().begin(), world->facts().end());
    call.end_after(std::chrono::seconds(1), {});
    return std::nullopt;
  }
  std::vector<std::vector<std::string>> seen;
};

/// Work that fetches something and plans from all facts, beside a watch of a minute that comes before it.
std::string watched_plan(const std::string& fetch, const std::string& of_watch = "") {
  return R"x(
mission: m
actions:
  watch: {resources: [{block: gauge}], outcomes: [low], )x" +
         of_watch + R"x(run: {simulated: {duration: 60s}}}
  fetch: {outcomes: [got, missed], effects: ["+fetched()"], run: {simulated: {duration: 5s, )x" +
         fetch + R"x(}}}
  plan: {pure: true, reads_world: true, run: {callback: plan}}
start: guarded
states:
  guarded:
    kind: preemptive
    outcomes: [done, low]
    on: {done: return success, low: return success}
    states:
      watch: {on: {low: return low}}
      work:
        on: {success: return done}
        start: fetch
        states:
          fetch: {on: {got: plan, missed: plan}}
          plan: {on: {success: return success}}
)x";
}

struct PlannedRun {
  explicit PlannedRun(const std::string& text) : run(text, {}, runners()) {}
  mission::Runners runners() const {
    mission::Runners all;
    all.add("plan", plan);
    return all;
  }
  std::shared_ptr<PlansFromFacts> plan = std::make_shared<PlansFromFacts>();
  VirtualRun run;
};

TEST(WorldInRaces, IsReadAheadBesideAWatch) {
  const PlannedRun planned(watched_plan("outcomes: [got]"));
  EXPECT_THAT(planned.run.executions(),
              UnorderedElementsAre("guarded/watch: preempted, 0 to 5", "guarded/work/fetch: got, 0 to 5",
                                   "guarded/work/plan: success, 0 to 1"));
  EXPECT_THAT(planned.plan->seen, ElementsAre(ElementsAre("fetched()")));
}

/// Nobody waits for the watch to know that.
TEST(WorldInRaces, IsReadAgainWhereItWasPredictedWrongly) {
  const PlannedRun planned(watched_plan("outcomes: [missed]"));
  EXPECT_THAT(planned.run.executions(),
              UnorderedElementsAre("guarded/watch: preempted, 0 to 6", "guarded/work/fetch: missed, 0 to 5",
                                   "guarded/work/plan: success, 5 to 6"));
  EXPECT_THAT(planned.plan->seen, ElementsAre(ElementsAre("fetched()"), IsEmpty()));
}

TEST(WorldInRaces, IsNotReadBesideWhatChangesIt) {
  const PlannedRun planned(watched_plan("outcomes: [got]", R"x(effects: ["+low()"], )x"));
  EXPECT_THAT(planned.run.executions(), Contains(HasSubstr("guarded: done, 0 to 6"))) << "as one node";
}

}  // namespace
}  // namespace segue::convert
