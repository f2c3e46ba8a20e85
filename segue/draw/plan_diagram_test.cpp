// SPDX-License-Identifier: Apache-2.0
// The nodes of a mission and the reasons of their dependencies: a mission for each reason.
#include <segue/convert/concurrent_run.hpp>
#include <segue/draw/plan_diagram.hpp>
#include <segue/mission/mission_io.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace segue::draw {
namespace {

using namespace convert;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::unique_ptr<MissionPlan> plan(const std::string& text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "test.yaml", diagnostics);
  if (mission) diagnostics.append(mission::validate(*mission));
  EXPECT_FALSE(diagnostics.has_errors()) << to_string(diagnostics);
  auto program = mission::Program::compile(std::move(*mission));
  EXPECT_TRUE(program);
  auto made = MissionPlan::create(*program);
  EXPECT_TRUE(made);
  return std::move(*made);
}

Diagram diagram(const std::string& text, std::size_t most = 1000) {
  const auto made = plan(text);
  EXPECT_TRUE(plan_ahead(*made, most));
  return diagram_of(*made);
}

std::uint32_t number(const Diagram& diagram, const std::string& name) {
  const auto found = std::ranges::find(diagram.nodes, name, &Diagram::Node::name);
  EXPECT_NE(found, diagram.nodes.end()) << name;
  return static_cast<std::uint32_t>(found - diagram.nodes.begin());
}
const Diagram::Node& node(const Diagram& diagram, const std::string& name) {
  return diagram.nodes.at(number(diagram, name));
}

/// Why one node comes after another, in words.
std::vector<std::string> causes(const Diagram& diagram, const std::string& from, const std::string& to) {
  std::vector<std::string> texts;
  for (const Diagram::Dependency& dependency : node(diagram, to).before) {
    if (diagram.nodes[dependency.from].name != from) continue;
    for (const Diagram::Cause& cause : dependency.causes)
      texts.push_back(to_string(cause));
  }
  return texts;
}

constexpr const char* kFetch = R"j(mission: fetch
actions:
  look:
    outputs: {pose: map}
    outcomes: [found, nothing]
    pure: true
    expect: {duration: 2s, outcome: found}
    run: {simulated: {duration: 2s}}
  grasp:
    inputs: {pose: map}
    preconditions: ["!holding(box)"]
    effects: ["+holding(box)"]
    resources: [{block: arm}]
    run: {simulated: {duration: 3s}}
  wave:
    resources: [{block: arm}]
    run: {simulated: {}}
  say: {run: {simulated: {}}}
outcomes: [done, failed]
start: look
flows:
  - look.pose -> grasp.pose
states:
  look: {on: {found: grasp, nothing: say}}
  grasp: {on: {success: wave}}
  wave: {on: {success: say}}
  say: {on: {success: return done}}
)j";

TEST(MissionDiagram, TellsDataConditionsResourcesAndPlaces) {
  const Diagram fetch = diagram(kFetch);
  EXPECT_THAT(causes(fetch, "look", "grasp"), ElementsAre("data pose -> pose", "condition found"));
  EXPECT_THAT(causes(fetch, "look", "wave"), ElementsAre("condition found"));
  EXPECT_THAT(causes(fetch, "grasp", "wave"),
              ElementsAre("resource arm: what is irreversible uses it in the program's order"));
  EXPECT_THAT(causes(fetch, "wave", "say"),
              ElementsAre("opaque say: it declares no facts and no resources, so it may touch anything"));
  EXPECT_THAT(causes(fetch, "look", "say"), IsEmpty()) << "all ways lead there";
  EXPECT_EQ(node(fetch, "look").role, Diagram::Role::Pure);
  EXPECT_EQ(node(fetch, "grasp").role, Diagram::Role::Irreversible);
  EXPECT_EQ(node(fetch, "say").note, "opaque");
  EXPECT_TRUE(fetch.complete);
}

TEST(MissionDiagram, TellsWhichFactIsTheMatter) {
  const Diagram made = diagram(R"j(mission: m
actions:
  open: {effects: ["+open(door)"], run: {simulated: {}}}
  look: {sensing: true, pure: false, preconditions: ["open(door)"], run: {simulated: {}}}
  pass: {inputs: {where: text}, preconditions: ["open({where})"], effects: ["-open({where})"], run: {simulated: {}}}
start: open
states:
  open: {on: {success: look}}
  look: {on: {success: pass}}
  pass: {inputs: {where: door}, on: {success: return success}}
)j");
  EXPECT_THAT(causes(made, "open", "look"), ElementsAre("world open(door): made true there, relied on here"));
  EXPECT_THAT(causes(made, "look", "pass"),
              ElementsAre("world open(door): relied on there, relied on and made false here"));
  EXPECT_EQ(node(made, "look").role, Diagram::Role::Sensing);
}

TEST(MissionDiagram, TellsOfJoinsCopiesAndGlobalVariables) {
  const Diagram made = diagram(R"j(mission: m
actions:
  ask: {outcomes: [a, b, c], pure: true, run: {simulated: {}}}
  use: {inputs: {x: {type: int, default: 0}}, pure: true, run: {simulated: {}}}
  idle: {pure: true, run: {simulated: {}}}
globals: {g: {type: int, default: 1}}
variables: {v: int}
start: ask
flows:
  - part.out -> variables.v
  - variables.v -> use.x
states:
  ask: {on: {a: part, b: part, c: return success}}
  part:
    outputs: {out: {type: int, default: $g}}
    on: {success: use}
    start: idle
    states:
      idle: {on: {success: return success}}
  use: {on: {success: return success}}
)j");
  EXPECT_EQ(node(made, "join").role, Diagram::Role::Join);
  EXPECT_EQ(node(made, "join").note, "of 2 ways");
  EXPECT_THAT(causes(made, "ask", "join").front(), HasSubstr("data outcome -> way"));
  EXPECT_EQ(node(made, "$g").role, Diagram::Role::Global);
  EXPECT_EQ(node(made, "$g").note, "the variable g");
  const bool copies = std::ranges::any_of(
      made.nodes, [](const Diagram::Node& one) { return one.role == Diagram::Role::Copy; });
  EXPECT_TRUE(copies);
}

TEST(MissionDiagram, SaysWhyAStateIsAnOpaqueSubtree) {
  const std::string actions = R"j(actions:
  say: {run: {simulated: {}}}
  turn: {effects: ["+turned()"], run: {simulated: {}}}
  turn_back: {effects: ["-turned()"], run: {simulated: {}}}
  both: {outcomes: [fine], run: {decide: [{outcome: fine}]}}
)j";
  const auto states = [](const std::string& kind, const std::string& inside) {
    return "start: s\nstates:\n  s:\n    kind: " + kind + "\n    on: {success: t}\n" + inside +
           "  t: {action: turn, on: {success: return success}}\n";
  };
  const Diagram first = diagram("mission: m\n" + actions + states("preemptive", R"j(    states:
      a: {action: turn, on: {success: return success}}
      b: {action: turn_back, on: {success: return success}}
)j"));
  EXPECT_EQ(node(first, "s").role, Diagram::Role::OpaqueSubtree);
  EXPECT_EQ(node(first, "s").note,
            "since b in it touches what another state touches, which must not decide which one ends first");
  EXPECT_THAT(causes(first, "s", "t"), ElementsAre("opaque subtree s: it may touch anything"));

  const Diagram second = diagram("mission: m\n" + actions + states("hierarchy", R"j(    start: a
    states:
      a: {action: turn, on: {success: return success, preempted: b}}
      b: {action: turn, on: {success: return success}}
)j"));
  EXPECT_EQ(node(second, "s").note, "since a preemption of a is handled in it");

  const Diagram third = diagram("mission: m\n" + actions + states("barrier", R"j(    states:
      a: {action: say, on: {success: return success}}
      b: {action: turn, on: {success: return success}}
      c: {kind: decider, action: both, on: {fine: return success}}
)j"));
  EXPECT_EQ(node(third, "s").note, "since a in it, concurrent with others, may touch anything");
}

constexpr const char* kLoop = R"j(mission: loop
actions:
  step: {outcomes: [more, done], effects: ["+a()"], run: {simulated: {outcomes: [more, more, more, done]}}}
start: step
states:
  step: {on: {more: step, done: return success}}
)j";

TEST(MissionDiagram, TellsWhereItMustKnowMore) {
  const Diagram made = diagram(kLoop);
  EXPECT_FALSE(made.complete);
  EXPECT_EQ(made.waits_for, "whether the loop at step goes on");
  EXPECT_THAT(to_text(made), HasSubstr("It goes on when it is known: whether the loop at step goes on\n"));
  EXPECT_THAT(causes(made, "step", "step#1"), ElementsAre("data executions -> executions", "condition more",
                                                          "world a(): made true there, made true here"));

  const Diagram named = diagram(R"j(mission: m
actions:
  find: {outputs: {what: text}, pure: true, run: {simulated: {outputs: {what: cup}}}}
  take: {inputs: {what: text}, effects: ["+held({what})"], run: {simulated: {}}}
start: find
flows: [find.what -> take.what]
states:
  find: {on: {success: take}}
  take: {on: {success: return success}}
)j");
  EXPECT_EQ(named.nodes.size(), 1U);
  EXPECT_EQ(named.waits_for, "the input what of take, which tells what it touches");
}

TEST(MissionDiagram, GoesOnAsIsAssumed) {
  mission::Runners runners;
  runners.simulate_all();
  const auto loop = plan(kLoop);
  const auto failure = plan_ahead(*loop, 1000, &runners);
  ASSERT_TRUE(failure);
  EXPECT_FALSE(*failure);
  const Diagram made = diagram_of(*loop);
  EXPECT_TRUE(made.complete);
  EXPECT_GE(made.nodes.size(), 4U);
}

TEST(MissionDiagram, WhatNeverEndsEndsAtTheHorizon) {
  mission::Runners runners;
  runners.simulate_all();
  const auto endless = plan(R"j(mission: endless
actions: {tick: {effects: ["+a()"], run: {simulated: {}}}}
start: tick
states: {tick: {on: {success: tick}}}
)j");
  ASSERT_TRUE(plan_ahead(*endless, 50, &runners));
  const Diagram made = diagram_of(*endless);
  EXPECT_GE(made.nodes.size(), 50U);
  EXPECT_LT(made.nodes.size(), 60U);
  EXPECT_FALSE(made.complete);
  EXPECT_THAT(to_text(made), HasSubstr("as far as the horizon reaches"));
}

TEST(MissionDiagram, TellsThatTheMissionWouldFail) {
  mission::Runners runners;
  runners.simulate_all();
  const auto made = plan(R"j(mission: m
actions: {take: {preconditions: ["near()"], run: {simulated: {}}}}
start: take
states: {take: {on: {success: return success}}}
)j");
  const auto failure = plan_ahead(*made, 50, &runners);
  ASSERT_TRUE(failure);
  ASSERT_TRUE(*failure);
  EXPECT_THAT((*failure)->message, HasSubstr("near()"));
}

}  // namespace
}  // namespace segue::draw
