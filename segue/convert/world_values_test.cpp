// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/test_support.hpp>
#include <segue/mission/world_values.hpp>
#include <segue/type/json.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::convert {
namespace {

using testing::VirtualRun;

/// Gives what it sees of the world as its output "seen".
class Look final : public mission::ActionRunner {
 public:
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    const auto world = call.world();
    type::ValueMap seen;
    for (const auto& [name, data] : world->data())
      seen.append(name, data->shown());
    call.set_output("seen", std::move(seen));
    call.end_after(std::chrono::seconds(1), {});
    return std::nullopt;
  }
};

mission::Runners runners() {
  mission::Runners runners;
  runners.add("look", std::make_shared<Look>());
  return runners;
}

/// A plan of one second for each of two motions of eight seconds; the second one begins where the first ends.
std::string planned_motions(const std::string& second_plan) {
  return R"x(
mission: m
world_data: {arm: {initial: {at: home}}}
resources: {arm: {}}
actions:
  plan: {inputs: {goal: text}, outputs: {end: {type: text, default: none}}, pure: true,
         run: {simulated: {duration: 1s, outputs: {end: table}}}}
  move: {inputs: {end: text}, resources: [{block: arm}], effects: [{arm.at: "{end}"}],
         run: {simulated: {duration: 8s}}}
  second: {outputs: {seen: any}, )x" +
         second_plan + R"x(, run: {callback: look}}
outputs: {seen: any}
start: plan
flows: [plan.end -> move.end, second.seen -> outputs.seen]
states:
  plan: {on: {success: move}}
  move: {on: {success: second}}
  second: {on: {success: return success}}
)x";
}

std::string seen(const VirtualRun& run) {
  return type::to_json(run.result.outputs.front(), -1);
}

TEST(WorldValues, AreReadAheadOnceWhatTheyWillBeIsKnown) {
  const VirtualRun run(planned_motions("pure: true, reads_world: [arm]"), {}, runners());
  EXPECT_EQ(run.executions(), (std::vector<std::string>{"plan: success, 0 to 1", "move: success, 1 to 9",
                                                        "second: success, 1 to 2"}));
  EXPECT_EQ(seen(run), R"({"arm":{"at":"table"}})");
}

TEST(WorldValues, AreRealForWhatActsOrSenses) {
  for (const std::string declared : {"sensing: true, reads_world: [arm], resources: [{block: eye}]",
                                     "reads_world: [arm], resources: [{block: hand}]"}) {
    const VirtualRun run(planned_motions(declared), {}, runners());
    EXPECT_EQ(run.executions().back(), "second: success, 9 to 10") << declared;
    EXPECT_EQ(seen(run), R"({"arm":{"at":"table"}})") << declared;
  }
}

TEST(WorldValues, AreSeenBesideFactsByWhatReadsTheWholeWorld) {
  const VirtualRun run(planned_motions("pure: true, reads_world: true"), {}, runners());
  EXPECT_EQ(seen(run), R"({"arm":{"at":"table"}})");
}

TEST(WorldValues, OfAnActionThatEndsOtherwiseAreAsBefore) {
  const std::string text = R"x(
mission: m
world_data: {arm: {initial: home}}
actions:
  move: {outcomes: [there, blocked], effects: [{arm: table}], resources: [{block: arm}],
         run: {simulated: {duration: 8s, outcomes: [blocked]}}}
  look: {outputs: {seen: any}, pure: true, reads_world: [arm], run: {callback: look}}
outputs: {seen: any}
start: move
flows: [look.seen -> outputs.seen]
states:
  move: {on: {there: look, blocked: look}}
  look: {on: {success: return success}}
)x";
  const VirtualRun run(text, {}, runners());
  EXPECT_EQ(seen(run), R"({"arm":"home"})");
  EXPECT_EQ(run.executions().back(), "look: success, 8 to 9") << "it had been expected to be there";
}

/// Whatever the work had not brought to its end when the battery was low has not happened.
TEST(WorldValues, OfWorkThatIsPreemptedAreThoseThatWereReached) {
  const std::string text = R"x(
mission: m
world_data: {box: {initial: {at: table, seen: 1}}}
resources: {arm: {}}
actions:
  take: {effects: [{box.at: hand}], resources: [{block: arm}], run: {simulated: {duration: 2s}}}
  put: {effects: [{box.at: deck}], resources: [{block: arm}], run: {simulated: {duration: 5s}}}
  battery: {resources: [{block: battery}], run: {simulated: {duration: 4s}}}
  look: {outputs: {seen: any}, pure: true, reads_world: [box], run: {callback: look}}
outputs: {seen: any}
start: guarded
flows: [look.seen -> outputs.seen]
states:
  guarded:
    kind: preemptive
    outcomes: [done, low]
    states:
      work:
        start: take
        states:
          take: {on: {success: put}}
          put: {on: {success: return success}}
        on: {success: return done}
      battery: {on: {success: return low}}
    on: {done: look, low: look}
  look: {on: {success: return success}}
)x";
  const VirtualRun run(text, {}, runners());
  EXPECT_EQ(seen(run), R"({"box":{"at":"hand","seen":1}})");
  const auto executions = run.executions();
  EXPECT_NE(std::ranges::find(executions, "guarded/work/take: success, 0 to 2"), executions.end())
      << "the container is divided";
}

TEST(WorldValues, ReachWhatRunsAsOneNodeAndComeBackFromIt) {
  const std::string text = R"x(
mission: m
world_data: {box: {initial: 1}}
actions:
  set: {inputs: {to: int}, effects: [{box: "{to}"}], resources: [{block: arm}], run: {simulated: {duration: 1s}}}
  anything: {run: {simulated: {duration: 1s}}}
  look: {outputs: {seen: any}, pure: true, reads_world: [box], run: {callback: look}}
outputs: {before: any, within: any, after: any}
start: first
flows: [within.within -> outputs.within, after.seen -> outputs.after]
states:
  first: {action: set, inputs: {to: 2}, on: {success: within}}
  within:   # which may touch anything, so it is not divided
    kind: preemptive
    outputs: {within: any}
    flows: [look.within -> outputs.within]
    states:
      look:
        outputs: {within: any}
        flows: [look.seen -> outputs.within]
        start: look
        states:
          look: {on: {success: set}}
          set: {inputs: {to: 3}, on: {success: return success}}
        on: {success: return success}
      anything: {on: {success: return success, aborted: return success}}
    on: {success: after}
  after: {action: look, on: {success: return success}}
)x";
  const VirtualRun run(text, {}, runners());
  EXPECT_EQ(type::to_json(run.result.outputs[1], -1), R"({"box":2})");
  EXPECT_EQ(run.executions().size(), 3U) << "the container is one node";
}

}  // namespace
}  // namespace segue::convert
