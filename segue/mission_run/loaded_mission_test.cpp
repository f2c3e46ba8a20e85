// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <thread>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kEndless = R"(mission: endless
actions:
  tick: {run: {simulated: {duration: 1s}}}
start: tick
states:
  tick: {on: {success: tick}}
)";
constexpr const char* kNetwork = R"j({"name": "n", "nodes": [
  {"name": "short", "duration_s": 1, "effects": ["+p()"]},
  {"name": "beside", "duration_s": 2, "effects": ["+q()"]},
  {"name": "after", "duration_s": 3, "preconditions": ["p()"], "effects": []}]})j";

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::vector<std::string> outputs_of(const FinishedRun& run) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : run.overview().outputs)
    texts.push_back(name + ": " + type::to_json(value));
  return texts;
}

TEST_F(LoadedMissions, AMissionEndsTheSameInEitherMode) {
  const LoadedMission plan = load("m.yaml", kGrasp);
  EXPECT_FALSE(plan.is_network());
  EXPECT_EQ(plan.name(), "m");
  const auto sequential = plan.run(request(Sequential{})).value();
  const auto concurrent = plan.run(request(Concurrent{})).value();
  for (const auto& run : {sequential.get(), concurrent.get()}) {
    EXPECT_TRUE(run->overview().succeeded);
    EXPECT_EQ(run->overview().name, "m");
    EXPECT_EQ(run->overview().outcome, "success");
    EXPECT_EQ(*run->overview().outputs.find("pose"), type::Value(7));
    EXPECT_EQ(run->overview().actions, 3U);
    EXPECT_EQ(seconds(run->comparison().sequential), 7);
    EXPECT_EQ(run->gantt().nodes.size(), 3U);
    EXPECT_EQ(run->to_value().find("outcome")->as_string(), "success");
  }
  EXPECT_EQ(seconds(sequential->overview().makespan), 7);
  EXPECT_EQ(seconds(concurrent->overview().makespan), 4);
}

TEST_F(LoadedMissions, RowsTellWhenAndWhy) {
  const LoadedMission plan = load("m.yaml", kGrasp);
  const auto sequential = plan.run(request(Sequential{})).value();
  const auto first = sequential->rows(2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_TRUE(sequential->as_written());
  EXPECT_EQ(first[1].name, "look");
  EXPECT_EQ(seconds(first[1].start), 4);
  EXPECT_EQ(seconds(first[1].end), 7);
  EXPECT_EQ(first[1].outcome, "success");
  const auto concurrent = plan.run(request(Concurrent{})).value();
  EXPECT_FALSE(concurrent->as_written());
  EXPECT_EQ(concurrent->rows()[2].waited_for, "world warm() of warm_up");
}

TEST_F(LoadedMissions, ProgressTellsOfEachActionInEitherMode) {
  const LoadedMission plan = load("m.yaml", kGrasp);
  for (const RunMode& mode : kBothModes) {
    std::vector<std::string> begun;
    std::vector<std::string> ended;
    RunRequest wanted = request(mode);
    wanted.on_event = [&](const mission::StateEvent& event) {
      if (event.kind == mission::StateEvent::Kind::Began) {
        begun.emplace_back(event.path);
      } else {
        ended.push_back(std::string(event.path) + ": " + std::string(event.outcome));
      }
    };
    ASSERT_TRUE(plan.run(wanted));
    EXPECT_THAT(begun, ::testing::UnorderedElementsAre("warm_up", "look", "grasp"));
    EXPECT_THAT(ended,
                ::testing::UnorderedElementsAre("warm_up: success", "look: success", "grasp: success"));
  }
}

TEST_F(LoadedMissions, AnActionThatAbortsIsReportedWithItsError) {
  const LoadedMission plan = load("m.yaml", kGrasp);
  for (const RunMode& mode : kBothModes) {
    std::vector<std::string> errors;
    RunRequest wanted = request(mode);
    wanted.runners.add("grasp", [](mission::ActionCall&) {
      return mission::Ending{mission::kAborted, "it slipped"};
    });
    wanted.on_event = [&](const mission::StateEvent& event) {
      if (!event.error.empty())
        errors.push_back(std::string(event.outcome) + ": " + std::string(event.error));
    };
    const auto run = plan.run(wanted).value();
    EXPECT_FALSE(run->overview().succeeded);
    EXPECT_EQ(run->overview().outcome, "aborted");
    ASSERT_TRUE(run->overview().error);
    EXPECT_EQ(run->overview().error->message, "it slipped");
    EXPECT_THAT(errors, ElementsAre("aborted: it slipped"));
  }
}

/// Fails inside, with outputs of every origin. What comes after the failure is pure and runs ahead.
constexpr const char* kFailing = R"j(mission: m
actions:
  look: {pure: true, outputs: {pose: int}, run: {simulated: {duration: 1s, outputs: {pose: 7}}}}
  count: {effects: ["+counted()"], outputs: {n: int}, run: {simulated: {duration: 1s, outputs: {n: 3}}}}
  grasp: {effects: ["+held()"], outputs: {force: {type: int, default: 4}}, run: {callback: grasp}}
  again: {pure: true, outputs: {pose: int}, run: {simulated: {duration: 1s, outputs: {pose: 8}}}}
start: look
outputs: {pose: int, n: int, force: int, never: {type: int, default: 9}, error: string}
flows: [look.pose -> outputs.pose, again.pose -> outputs.pose, inner.n -> outputs.n, inner.force -> outputs.force]
states:
  look: {on: {success: inner}}
  inner:
    outputs: {n: int, force: int}
    flows: [count.n -> outputs.n, grasp.force -> outputs.force]
    start: count
    states:
      count: {on: {success: grasp}}
      grasp: {on: {success: return success}}
    on: {success: again}
  again: {on: {success: return success}}
)j";

TEST_F(LoadedMissions, ARunThatAbortsKeepsItsOutputsInEitherMode) {
  const LoadedMission plan = load("m.yaml", kFailing);
  for (const RunMode& mode : kBothModes) {
    RunRequest wanted = request(mode);
    wanted.runners.add("grasp", [](mission::ActionCall& call) {
      call.set_output("force", type::Value(5));
      return mission::Ending{mission::kAborted, "it slipped"};
    });
    const auto run = plan.run(wanted).value();
    EXPECT_EQ(run->overview().outcome, "aborted");
    EXPECT_THAT(outputs_of(*run),
                ElementsAre("pose: 7", "n: 3", "force: 5", "never: 9", "error: \"it slipped\""));
  }
}

TEST_F(LoadedMissions, AContainerThatAbortsGivesItsErrorInEitherMode) {
  const LoadedMission plan = load("m.yaml", R"j(mission: m
actions:
  grasp: {effects: ["+held()"], run: {callback: grasp}}
  rest: {effects: ["+rested()"], run: {simulated: {duration: 1s}}}
start: inner
outputs: {why: string}
flows: [inner.error -> outputs.why]
states:
  inner:
    outputs: {error: string}
    start: grasp
    states: {grasp: {on: {success: return success}}}
    on: {success: return success, aborted: rest}
  rest: {on: {success: return success}}
)j");
  for (const RunMode& mode : kBothModes) {
    RunRequest wanted = request(mode);
    wanted.runners.add("grasp", [](mission::ActionCall&) {
      return mission::Ending{mission::kAborted, "it slipped"};
    });
    const auto run = plan.run(wanted).value();
    EXPECT_TRUE(run->overview().succeeded);
    EXPECT_THAT(outputs_of(*run), ElementsAre("why: \"it slipped\""));
  }
}

TEST_F(LoadedMissions, WhatARunDoesNotReachHasNoOutcome) {
  const LoadedMission plan = load("m.yaml", kFailing);
  RunRequest wanted = request(Concurrent{});
  wanted.runners.add("grasp", [](mission::ActionCall&) { return mission::Ending{mission::kAborted, "no"}; });
  const auto run = plan.run(wanted).value();
  const type::Value json = run->to_value();
  std::vector<std::string> outcomes;
  for (const type::Value& node : json.find("nodes")->as_list())
    outcomes.push_back(node.find("name")->as_string() + ": " + node.find("outcome")->as_string());
  EXPECT_THAT(outcomes,
              ElementsAre("look: success", "inner/count: success", "inner/grasp: aborted", "again: "));
  EXPECT_THAT(run->rows().back().outcome, IsEmpty());
  EXPECT_THAT(run->gantt().nodes.back().outcome, IsEmpty());
}

TEST_F(LoadedMissions, AStopFromAnotherThreadEndsTheRun) {
  const LoadedMission plan = load("m.yaml", kEndless);
  for (const RunMode& mode : kBothModes) {
    RunRequest wanted = request(mode);
    std::stop_source stop;
    std::atomic<bool> goes_on = false;
    wanted.on_event = [&](const mission::StateEvent&) {
      goes_on = true;
      goes_on.notify_all();
    };
    std::jthread other([&] {
      goes_on.wait(false);
      stop.request_stop();
    });
    const auto run = plan.run(wanted, stop.get_token()).value();
    EXPECT_FALSE(run->overview().succeeded);
    EXPECT_EQ(run->overview().outcome, "preempted");
  }
}

TEST_F(LoadedMissions, AStopBeforeTheRunLeavesNothingDone) {
  std::stop_source stop;
  stop.request_stop();
  for (const auto& [file, text] : {std::pair("m.yaml", kEndless), std::pair("n.json", kNetwork)}) {
    const LoadedMission plan = load(file, text);
    for (const RunMode& mode : kBothModes) {
      const auto run = plan.run(request(mode), stop.get_token()).value();
      EXPECT_FALSE(run->overview().succeeded) << file;
      for (const RunRow& row : run->rows())
        EXPECT_NE(row.status, task_network::NodeStatus::Done) << file << ' ' << row.name;
    }
  }
}

TEST_F(LoadedMissions, ANetworkRunsInEitherMode) {
  const LoadedMission plan = load("n.json", kNetwork);
  EXPECT_TRUE(plan.is_network());
  EXPECT_EQ(plan.program(), nullptr);
  const auto sequential = plan.run(request(Sequential{})).value();
  const auto concurrent = plan.run(request(Concurrent{})).value();
  EXPECT_EQ(seconds(sequential->overview().makespan), 6);
  EXPECT_EQ(seconds(concurrent->overview().makespan), 4);
  EXPECT_EQ(concurrent->overview().outcome, "done");
  EXPECT_EQ(seconds(concurrent->comparison().sequential), 6);
  EXPECT_EQ(seconds(concurrent->comparison().critical_path), 4);
  EXPECT_EQ(concurrent->gantt().nodes.size(), 3U);
}

TEST_F(LoadedMissions, ConvertShowsTheNodesBeforeAnyRun) {
  const LoadedMission mission = load("m.yaml", kGrasp);
  const auto nodes = mission.convert({}).value().nodes;
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(nodes[2].name, "grasp");
  EXPECT_EQ(nodes[2].before.size(), 2U);
  ConvertRequest far;
  far.horizon = 20;
  far.assume_expected = true;
  EXPECT_GE(load("e.yaml", kEndless).convert(far).value().nodes.size(), 20U);
  EXPECT_EQ(load("n.json", kNetwork).convert({}).value().nodes.size(), 3U);
}

TEST_F(LoadedMissions, WhatCannotBeRequestedIsRefusedBeforeTheRun) {
  const LoadedMission mission = load("m.yaml", kGrasp);
  const LoadedMission network = load("n.json", kNetwork);
  RunRequest odd = request(Sequential{});
  odd.inputs.append("x", 1);
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::NotFound);
  EXPECT_EQ(network.run(odd).error().code, ErrorCode::Unsupported);
  odd = request(Concurrent{});
  odd.inputs.append("force", "strong");
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::TypeMismatch);
  EXPECT_EQ(mission.run(request(Sequential{.start_at = "nowhere"})).error().code, ErrorCode::NotFound);
  EXPECT_EQ(network.run(request(Sequential{.start_at = "short"})).error().code, ErrorCode::Unsupported);
  odd = request(Sequential{});
  odd.facts = {"(("};
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::ParseError);
  odd = request(Concurrent{});
  odd.resources = {{"nothing", 2}};
  EXPECT_EQ(network.run(odd).error().code, ErrorCode::NotFound);
  EXPECT_EQ(mission.run({}).error().code, ErrorCode::NotFound) << "no callback";
  odd = request(Concurrent{});
  odd.resources = {{"nothing", 2}};
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::NotFound);
  odd.mode = Sequential{};
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::NotFound);
  odd = request(Concurrent{});
  odd.order = task_network::OrderRule::Goal;
  EXPECT_EQ(mission.run(odd).error().code, ErrorCode::Unsupported);
}

TEST_F(LoadedMissions, FactsThatAreGivenFitTheMissionsPredicates) {
  const LoadedMission mission = load("typed.yaml", R"y(mission: typed
objects: {dock: object}
predicates: {at: [object]}
actions: {go: {effects: ["-at(dock)"], run: {simulated: {duration: 1s}}}}
start: go
states: {go: {on: {success: return success}}}
)y");
  for (RunRequest given : {request(Sequential{}), request(Concurrent{})}) {
    given.facts = {"at(dock)"};
    EXPECT_TRUE(mission.run(given));
    given.facts = {"at(dok)"};
    EXPECT_THAT(mission.run(given).error().message, HasSubstr("the fact 'at(dok)' has the argument 'dok'"));
  }
}

TEST_F(LoadedMissions, ANumberOfNothingIsRefused) {
  const LoadedMission network = load("n.json", kNetwork);
  EXPECT_EQ(network.run(request(Concurrent{.workers = 0})).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(network.run(request(Concurrent{.world_copies = 0})).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(network.run(request(Concurrent{.ahead = 0})).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(network.run(request(Concurrent{.least_likelihood = 1.5})).error().code,
            ErrorCode::InvalidArgument);
  RunRequest odd = request(Sequential{});
  odd.seed = 0;
  EXPECT_EQ(network.run(odd).error().code, ErrorCode::InvalidArgument);
  odd.seed = 1;
  EXPECT_TRUE(network.run(odd));
}

TEST_F(LoadedMissions, EveryProblemOfAFileIsReported) {
  const auto file = write("broken.yaml", "mission: x\nstart: nowhere\nstates: {}\n");
  const auto broken = LoadedMission::load(file);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::InvalidArgument);
  ASSERT_TRUE(broken.error().diagnostics);
  EXPECT_TRUE(broken.error().diagnostics->has_errors());
  EXPECT_THAT(to_string(*broken.error().diagnostics), HasSubstr("nowhere"));
  const auto network = LoadedMission::load(write("broken.json", R"({"nodes": [{"name": 3}]})"));
  ASSERT_FALSE(network);
  EXPECT_TRUE(diagnostics_of(network.error()).has_errors());
  EXPECT_FALSE(LoadedMission::load(folder_ / "missing.yaml"));
}

TEST_F(LoadedMissions, WarningsAreKept) {
  EXPECT_TRUE(load("m.yaml", kGrasp).warnings().empty());
  EXPECT_TRUE(load("n.json", kNetwork).warnings().empty());
  std::string twice = kGrasp;
  twice.insert(twice.find("\"+warm()\""), "\"+warm()\", ");
  EXPECT_THAT(to_string(load("twice.yaml", twice).warnings()), HasSubstr("warning: "));
}

TEST_F(LoadedMissions, AMissionNeedsNoFile) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(kGrasp, "m.yaml", diagnostics);
  ASSERT_TRUE(mission);
  const LoadedMission plan = LoadedMission::create(std::move(*mission)).value();
  EXPECT_TRUE(plan.run(request(Concurrent{})).value()->overview().succeeded);

  auto broken = mission::read_mission(kEndless, "m.yaml", diagnostics);
  ASSERT_TRUE(broken);
  broken->states.back().action = mission::ActionName("missing");
  EXPECT_EQ(LoadedMission::create(std::move(*broken)).error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace segue::mission_run
