// SPDX-License-Identifier: Apache-2.0
// RAFCON's machines in tests/rafcon, with their scripts, as they are written and concurrently: both do what
// RAFCON does.
#include <segue/convert/concurrent_run.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/type/json.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace segue::convert {
namespace {

using mission::MissionResult;
using ::testing::HasSubstr;
using type::Value;
using type::ValueMap;

const std::filesystem::path kMachines = segue::paths::in_sources("/tests/rafcon");

/// The result of a run.
struct Ran {
  MissionResult result;
  Value globals;
  std::shared_ptr<const mission::Program> program;

  [[nodiscard]] std::string output(std::string_view name) const {
    const auto& ports = *program->node(0).output_ports;
    for (std::size_t i = 0; i < ports.size(); ++i) {
      if (ports[i].name == name) return type::to_json(result.outputs[i], -1);
    }
    return "no output " + std::string(name);
  }
};

enum class How { AsWritten, Concurrently };

class RafconMachine : public ::testing::TestWithParam<How> {
 protected:
  Ran run(const std::string& name, const Value& input = {}) {
    Diagnostics diagnostics;
    auto imported = mission::import_rafcon(kMachines / name, {{"own", kMachines / "libraries"}}, diagnostics);
    EXPECT_TRUE(imported) << to_string(diagnostics);
    if (!imported) return {};
    if (!input.is_null()) imported->mission.states.front().inputs.front().value = input;
    Ran ran;
    ran.program = mission::Program::compile(std::move(imported->mission)).value();
    mission::Runners runners;
    runners.set_scripts(std::make_shared<mission::ScriptRunner>(mission::ScriptOptions{}));
    if (GetParam() == How::AsWritten) {
      const auto engine = mission::Engine::create(ran.program, runners).value();
      engine->run();
      ran.result = engine->result();
      ran.globals = engine->globals().snapshot();
    } else {
      const auto concurrent = Run::create(ran.program, runners, {}).value();
      ran.result = concurrent->run();
      ran.globals = concurrent->globals().snapshot();
    }
    return ran;
  }
};

TEST_P(RafconMachine, CountsDown) {
  const Ran ran = run("count_down");
  EXPECT_EQ(ran.result.outcome_name, "finished") << ran.result.error;
  EXPECT_EQ(ran.output("left"), "0");
}

TEST_P(RafconMachine, GoesRoundWithVariablesAndALibraryWhoseDefaultIsOverridden) {
  const Ran ran = run("rounds");
  EXPECT_EQ(ran.result.outcome_name, "done") << ran.result.error;
  EXPECT_EQ(ran.output("total"), "7") << "1, and twice 3";
  EXPECT_THAT(ran.output("why"), HasSubstr("cannot take 7")) << "the abort within went up and was handled";
  EXPECT_EQ(type::to_json(ran.globals, -1), R"({"limit":7,"rounds":2})");
}

TEST_P(RafconMachine, LetsADeciderAskForTheOthersByNameAndId) {
  const Ran ran = run("judges");
  EXPECT_EQ(ran.result.outcome_name, "one") << ran.result.error;
  EXPECT_EQ(
      ran.output("seen"),
      R"({"ends":{"FINEAA":[1,"right",false],"NESTED":[-1,"aborted",true],"COUNTS":[0,"success",false]},)"
      R"("by_name":"right","me":"unique_decider_state_id","nobody":null,"no_error":null})");
}

TEST_P(RafconMachine, PreemptsWhoeverIsSlowerAndHandlesThat) {
  const Ran ran = run("race");
  EXPECT_EQ(ran.result.outcome_name, "won") << ran.result.error;
  EXPECT_EQ(ran.output("who"), "\"quick\"");
  EXPECT_EQ(ran.output("handled"), "true");
  EXPECT_EQ(type::to_json(ran.globals, -1), R"({"handled":true})");
}

TEST_P(RafconMachine, RunsAsFarAsItIsFinished) {
  const Ran ran = run("unfinished");
  EXPECT_EQ(ran.result.outcome_name, "success") << ran.result.error;
  EXPECT_EQ(ran.output("told"), "\"good\"");
}

TEST_P(RafconMachine, AbortsWhereAnOutcomeWithoutTransitionIsReached) {
  const Ran ran = run("unfinished", "bad");
  EXPECT_EQ(ran.result.outcome, mission::kAborted);
  EXPECT_EQ(ran.result.error, "state 'asks' ended with 'bad', whose transition aborts");
  EXPECT_EQ(ran.output("told"), "\"bad\"");
}

TEST_P(RafconMachine, GivesUpWithTheErrorOfAnAbortThatNobodyHandles) {
  const Ran ran = run("gives_up");
  EXPECT_EQ(ran.result.outcome, mission::kAborted);
  EXPECT_THAT(ran.result.error, HasSubstr("no such outcome"));
  EXPECT_EQ(type::to_json(ran.globals, -1), R"({"began":true})");
}

TEST_P(RafconMachine, GivesScriptsAllOfRafconsInterface) {
  const Ran ran = run("interface");
  EXPECT_EQ(ran.result.outcome_name, "all") << ran.result.error;
  EXPECT_EQ(
      ran.output("told"),
      R"({"name":"asks","id":"ASKSAA","path":"interface/asks","inputs":{"text":"given","things":[1,2]},)"
      R"("outcomes":{"-2":[-2,"preempted"],"-1":[-1,"aborted"],"0":[0,"all"],"1":[1,"some"]},"run_id":true,)"
      R"("flags":[false,false,true],"waits":[false,false,true],"typed":true,"default":4,"locked":[true,false,true],)"
      R"("text":"b","wrong_key":true,"keys":["other","text"],"starting":["text"],)"
      R"("all":{"other":[1,{"x":null}],"text":"b"},"there":[true,false],"reference":"b","deleted":false})");
}

TEST_P(RafconMachine, PassesLiveObjectsByReferenceThroughGlobalVariables) {
  const Ran ran = run("live_objects");
  EXPECT_EQ(ran.result.outcome_name, "success") << ran.result.error;
  EXPECT_EQ(type::to_json(ran.globals, -1), R"({"poses":[1,2,3],"published":["pose"]})");
}

INSTANTIATE_TEST_SUITE_P(Runs, RafconMachine, ::testing::Values(How::AsWritten, How::Concurrently),
                         [](const auto& one) {
                           return one.param == How::AsWritten ? "AsWritten" : "Concurrently";
                         });

}  // namespace
}  // namespace segue::convert
