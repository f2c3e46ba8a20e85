// SPDX-License-Identifier: Apache-2.0
//
// Runs with a journal, which later runs continue.
#include <segue/mission/program.hpp>
#include <segue/mission_engine/run_journal.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>

#include <gmock/gmock.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST_F(LoadedMissions, AJournalLetsALaterRunContinue) {
  const LoadedMission plan = load("m.yaml", kGrasp);
  for (const RunMode& mode : kBothModes) {
    const bool concurrent = is_concurrent(mode);
    RunRequest wanted = request(mode);
    wanted.journal = Journal{folder_ / (concurrent ? "concurrent" : "sequential")};
    std::stop_source stop;
    wanted.on_event = [&](const mission::StateEvent& event) {
      if (event.kind == mission::StateEvent::Kind::Ended && event.path == "look") stop.request_stop();
    };
    EXPECT_EQ(plan.run(wanted, stop.get_token()).value()->overview().outcome, "preempted");
    EXPECT_EQ(plan.run(wanted).error().code, ErrorCode::AlreadyExists);

    std::vector<std::string> begun;
    std::vector<std::string> notes;
    // Concurrently the grasp may have begun before the stop was heeded.
    wanted.journal->resume = concurrent ? mission::UnderWay::Again : mission::UnderWay::Refuse;
    wanted.note = [&](const std::string& text) { notes.push_back(text); };
    wanted.on_event = [&](const mission::StateEvent& event) {
      if (event.kind == mission::StateEvent::Kind::Began) begun.emplace_back(event.path);
    };
    const auto run = plan.run(wanted).value();
    EXPECT_EQ(run->overview().outcome, "success");
    EXPECT_EQ(*run->overview().outputs.find("pose"), type::Value(7)) << "from the journal";
    // Concurrently it looks while it warms up.
    EXPECT_EQ(begun, concurrent ? std::vector<std::string>({"warm_up", "grasp"})
                                : std::vector<std::string>({"grasp"}));
    EXPECT_THAT(notes, ElementsAre(concurrent ? "the run is resumed: 1 action had ended"
                                              : "the run is resumed: 2 actions had ended"));
    EXPECT_EQ(plan.run(wanted).error().code, ErrorCode::InvalidState) << "it has ended";
  }
}

TEST_F(LoadedMissions, ARunIsResumedWithWhatItBeganWith) {
  std::string text = kGrasp;
  text.insert(text.find("run: {callback: grasp}"), "resources: [{block: hand}], ");
  const LoadedMission plan = load("m.yaml", text);
  RunRequest wanted = request(Sequential{});
  wanted.journal = Journal{folder_ / "journal"};
  wanted.inputs.set("force", 2);
  wanted.facts = {"warm()"};
  wanted.resources = {{"hand", 3}};
  wanted.seed = 4;
  std::stop_source stop;
  wanted.on_event = [&](const mission::StateEvent& event) {
    if (event.kind == mission::StateEvent::Kind::Ended && event.path == "look") stop.request_stop();
  };
  const auto first = plan.run(wanted, stop.get_token());
  ASSERT_TRUE(first) << to_string(first.error());
  EXPECT_EQ((*first)->overview().outcome, "preempted");
  wanted.journal->resume = mission::UnderWay::Refuse;
  wanted.on_event = {};

  const auto error_with = [&](const std::function<void(RunRequest&)>& change) {
    RunRequest other = wanted;
    change(other);
    const auto run = plan.run(other);
    return run ? "it has been resumed" : run.error().message;
  };
  EXPECT_THAT(error_with([](RunRequest& other) { other.inputs.set("force", 3); }),
              EndsWith("the input 'force' was 2 and is 3"));
  EXPECT_THAT(error_with([](RunRequest& other) { other.inputs.set("weight", 3); }),
              EndsWith("the input 'weight' was not given and is 3"));
  EXPECT_THAT(error_with([](RunRequest& other) { other.facts = {"!warm()"}; }),
              EndsWith("its facts were others"));
  EXPECT_THAT(error_with([](RunRequest& other) { other.mode = Sequential{.start_at = "grasp"}; }),
              EndsWith("it began at its start"));
  EXPECT_THAT(error_with([](RunRequest& other) { other.seed = 5; }), EndsWith("its seed was 4"));
  EXPECT_THAT(error_with([](RunRequest& other) {
                other.resources = {{"hand", 2}};
              }),
              EndsWith("there are 2 units of the resource 'hand', 3 then"));
  EXPECT_THAT(error_with([](RunRequest& other) {
                other.resources = {{"foot", 2}};
              }),
              EndsWith("there are 2 units of the resource 'foot', as many as the mission says then"));
  EXPECT_EQ(error_with([](RunRequest& /*other*/) {}), "it has been resumed") << "the same again";
}

TEST_F(LoadedMissions, AScriptThatWasInterruptedIsRefusedForWhatIsMissing) {
  write("grasp.py", "def execute(self, inputs, outputs, gvm):\n    return 0\n");
  const LoadedMission plan = load("m.yaml",
                                  "mission: m\n"
                                  "actions: {grasp: {run: {python: grasp.py}}}\n"
                                  "action: grasp\n");
  const auto file = folder_ / "journal";
  mission::RunJournal::create(file, plan.program()->mission(), {}).value()->began({""}, true, "grasp");
  RunRequest wanted = request(Sequential{});
  wanted.journal = Journal{file, mission::UnderWay::GoOn};
  const auto run = plan.run(wanted);
  ASSERT_FALSE(run);
  EXPECT_THAT(run.error().message, HasSubstr("cannot go on: nobody can see how far it got"));
  EXPECT_THAT(run.error().message, EndsWith("--under-way again, skip or abort"));
}

}  // namespace
}  // namespace segue::mission_run
