// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_engine/interrupted_journal.hpp>

#include <support/full_disk.hpp>

#include <unistd.h>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace segue::mission {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMission = R"(
mission: m
globals: {seen: {type: int, default: 0}}
actions:
  look: {outputs: {n: float}, pure: true, run: {callback: look}}
  grasp: {inputs: {n: float}, outcomes: [held, lost], expect: {outcome: lost}, run: {callback: grasp}}
outputs: {n: float}
outcomes: [held, lost]
start: look
flows: [look.n -> grasp.n, look.n -> outputs.n]
states:
  look: {on: {success: grasp}}
  grasp: {on: {held: return held, lost: return lost}}
)";

class RunJournals : public ::testing::Test {
 protected:
  RunJournals() {
    Diagnostics diagnostics;
    program_ = Program::compile(read_mission(kMission, "m.yaml", diagnostics).value()).value();
    runners_.add("look", [this](ActionCall& call) {
      ++looks_;
      call.set_output("n", type::Value(2.0));
      EXPECT_TRUE(call.globals().set("seen", type::Value(1)));
      EXPECT_TRUE(call.globals().set("new", type::Value("text")));
      return Ending{};
    });
    runners_.add("grasp", [this](ActionCall& call) {
      ++grasps_;
      EXPECT_EQ(call.input("n"), type::Value(2.0));
      EXPECT_EQ(call.globals().get("seen"), type::Value(1));
      EXPECT_EQ(call.globals().get("new"), type::Value("text"));
      return Ending{};
    });
  }
  ~RunJournals() override { std::filesystem::remove(file_); }

  MissionResult run(Result<std::unique_ptr<RunJournal>> journal) {
    EXPECT_TRUE(journal) << to_string(journal.error());
    EngineOptions options;
    options.journal = std::move(*journal);
    auto engine = Engine::create(program_, runners_, options).value();
    engine->run();
    return engine->result();
  }
  [[nodiscard]] const Mission& mission() const { return program_->mission(); }
  Result<std::unique_ptr<RunJournal>> resume(UnderWay under_way = UnderWay::Refuse) {
    return RunJournal::resume(file_, mission(), false, under_way,
                              [this](const std::string& text) { told_ = text; });
  }
  Result<std::unique_ptr<RunJournal>> create() {
    return RunJournal::create(file_, mission(), {}, [this](const std::string& text) { told_ = text; });
  }
  /// Leaves what a run does that is killed when its journal has so many entries.
  void break_off_after(int entries) {
    (void)run(create());
    const std::string text = read_file(file_).value();
    std::size_t end = 0;
    for (int i = 0; i < entries + 2; ++i)
      end = text.find('\n', end) + 1;
    ASSERT_TRUE(write_file(file_, interrupted_journal(text, end)));
    looks_ = grasps_ = 0;
  }

  std::filesystem::path file_ =
      std::filesystem::path(::testing::TempDir()) / ("segue_run_journal_" + std::to_string(::getpid()));
  std::shared_ptr<const Program> program_;
  Runners runners_;
  int looks_ = 0;
  int grasps_ = 0;
  std::function<void()> stop_;
  std::string told_;
};

TEST_F(RunJournals, WhatHasEndedIsNotExecutedAgain) {
  break_off_after(2);
  const auto result = run(resume());
  EXPECT_EQ(result.outcome_name, "held");
  EXPECT_EQ(result.outputs.at(0), type::Value(2.0));
  EXPECT_EQ(looks_, 0);
  EXPECT_EQ(grasps_, 1);
  EXPECT_THAT(to_string(resume().error()), HasSubstr("has ended"));
}

TEST_F(RunJournals, ARunIsResumedWithWhatItBeganWith) {
  {
    RunJournal::Start start;
    start.resources = {{"cup", 2}};
    start.seed = 7;
    auto journal = RunJournal::create(file_, mission(), start).value();
    journal->ended({"look"}, {0, "", false, {}, {}, {}, {"p()"}, {{"cup", -1}}, {{1, 2}}});
  }
  const auto journal = RunJournal::resume(file_, mission(), false, UnderWay::Again).value();
  EXPECT_EQ(journal->start().resources, (UnitCounts{{"cup", 2}}));
  EXPECT_EQ(journal->start().seed, 7);
  EXPECT_EQ((*journal)[0].units, (UnitChanges{{"cup", -1}}));
  EXPECT_EQ((*journal)[0].begun, (std::map<StateIndex, std::uint32_t>{{1, 2}}));
}

TEST_F(RunJournals, PureActionsThatWereUnderWayAreExecutedAgain) {
  break_off_after(1);
  EXPECT_EQ(run(resume()).outcome_name, "held");
  EXPECT_EQ(looks_, 1);
}

TEST_F(RunJournals, SomebodySaysWhatBecomesOfWhatMayNotBeRepeated) {
  break_off_after(3);
  EXPECT_THAT(to_string(resume().error()), HasSubstr("'grasp' had begun but not ended"));
  const std::string text = read_file(file_).value();
  EXPECT_EQ(run(resume(UnderWay::Skip)).outcome_name, "lost") << "what was expected";
  EXPECT_EQ(grasps_, 0);
  ASSERT_TRUE(write_file(file_, text));
  EXPECT_THAT(run(resume(UnderWay::Abort)).error, HasSubstr("had begun but not ended"));
  EXPECT_EQ(grasps_, 0);
  ASSERT_TRUE(write_file(file_, text));
  EXPECT_EQ(run(resume(UnderWay::Again)).outcome_name, "held");
  EXPECT_EQ(grasps_, 1);
}

TEST_F(RunJournals, ARunThatWasStoppedGoesOnFromThere) {
  class UntilStopped final : public ActionRunner {
   public:
    UntilStopped(int& calls, std::function<void()>& stop) : calls_(calls), stop_(stop) {}
    std::optional<Ending> start(ActionCall& call) override {
      if (++calls_ == 2) return Ending{*call.outcome("lost"), {}};
      auto completer = std::make_shared<Completer>();
      *completer = call.defer([completer] { (*completer)({0, {}}, {}); });
      stop_();
      return std::nullopt;
    }

   private:
    int& calls_;
    std::function<void()>& stop_;
  };
  runners_.add("grasp", std::make_shared<UntilStopped>(grasps_, stop_));
  EngineOptions options;
  options.journal = create().value();
  auto engine = Engine::create(program_, runners_, options).value();
  stop_ = [&] { engine->stop(); };
  engine->run();
  EXPECT_EQ(engine->result().outcome, kPreempted);
  engine.reset();
  options.journal.reset();
  EXPECT_EQ(run(resume(UnderWay::Again)).outcome_name, "lost");
  EXPECT_EQ(grasps_, 2);
  EXPECT_EQ(looks_, 1);
}

TEST_F(RunJournals, OneRunOneJournal) {
  const auto first = create();
  ASSERT_TRUE(first);
  EXPECT_EQ(create().error().code, ErrorCode::AlreadyExists);
  EXPECT_THAT(to_string(resume().error()), HasSubstr("another run is writing"));
}

TEST_F(RunJournals, OthersAreRefused) {
  EXPECT_EQ(resume().error().code, ErrorCode::NotFound);
  ASSERT_TRUE(write_file(file_, ""));
  EXPECT_THAT(to_string(resume().error()), HasSubstr("it is empty"));
  ASSERT_TRUE(write_file(file_, "{\"name\": 1}\n"));
  EXPECT_THAT(to_string(resume().error()), HasSubstr("its first line does not identify one"));
  std::filesystem::remove(file_);
  break_off_after(0);
  Mission other = mission();
  other.actions.front().pure = false;
  EXPECT_THAT(to_string(RunJournal::resume(file_, other, false, UnderWay::Again).error()),
              HasSubstr("another one"));
}

TEST_F(RunJournals, ALinkIsNotFollowed) {
  const std::filesystem::path target = file_.string() + ".elsewhere";
  std::filesystem::create_symlink(target, file_);
  const auto created = create();
  ASSERT_FALSE(created);
  EXPECT_THAT(created.error().message, HasSubstr("is a symbolic link"));
  const auto resumed = resume();
  ASSERT_FALSE(resumed);
  EXPECT_THAT(resumed.error().message, HasSubstr("is a symbolic link"));
  EXPECT_FALSE(std::filesystem::exists(target));
}

TEST_F(RunJournals, AJournalThatDoesNotFitOnTheDiskIsNotBegun) {
  const testing::FullDisk full(100);
  EXPECT_EQ(create().error().code, ErrorCode::IoError);
  EXPECT_FALSE(std::filesystem::exists(file_)) << "so that it can be begun when there is room";
}

TEST_F(RunJournals, WhatAFullDiskDoesNotTakeIsWrittenWhenItHasRoom) {
  {
    auto journal = create().value();
    journal->began({"look"}, false);
    {
      const testing::FullDisk full(std::filesystem::file_size(file_) + 20);
      journal->ended({"look"}, {0, "", false, {type::Value(2.0)}, {}, {}});
      EXPECT_THAT(told_, HasSubstr("cannot be written"));
      journal->began({"grasp"}, true, "grasp");
    }
    journal->ended({"grasp"}, {0, "", false, {}, {}, {}});
    EXPECT_THAT(told_, HasSubstr("complete again"));
  }
  const auto resumed = resume();
  ASSERT_TRUE(resumed) << to_string(resumed.error());
  EXPECT_EQ((*resumed)->size(), 2U);
}

TEST_F(RunJournals, ARunIsNotResumedWhereAFullDiskHasNotTakenWhatItDid) {
  {
    auto journal = create().value();
    journal->began({"look"}, false);
    const testing::FullDisk full(std::filesystem::file_size(file_) + 20);
    journal->began({"grasp"}, true, "grasp");
    journal->close();
  }
  EXPECT_THAT(to_string(resume(UnderWay::Again).error()), HasSubstr("entry 2 is missing at its end"));
}

TEST_F(RunJournals, OnesOfOlderVersionsAreRefused) {
  ASSERT_TRUE(write_file(file_, "{\"segue_mission_run\":1,\"mission\":\"m\",\"digest\":\"1\"}\n"));
  EXPECT_THAT(to_string(resume().error()), HasSubstr("another version of Segue"));
}

RC_GTEST_PROP(RunJournal, AnyFileIsReadOrRefused, ()) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("segue_any_journal_" + std::to_string(::getpid()));
  Diagnostics diagnostics;
  const Mission mission = read_mission(kMission, "m.yaml", diagnostics).value();
  std::filesystem::remove(file);
  {
    RunJournal::Start start;
    start.resources = {{"cup", 2}};
    start.seed = 7;
    auto journal = RunJournal::create(file, mission, start).value();
    journal->began({"look"}, false);
    journal->first({"look", 0, "1"});
    journal->ended({"look"}, {0, "e", false, {type::Value(1)}, {}, {}, {"p()"}, {{"cup", -1}}, {{1, 2}}},
                   type::Value::map({{"g", 1}}));
    journal->began({"grasp"}, true);
  }
  std::string text = read_file(file).value();
  const auto damages = *rc::gen::inRange(1, 4);
  for (int i = 0; i < damages; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
    text[at] = *rc::gen::elementOf(std::string("{}[]\",:0a\n-"));
  }
  RC_ASSERT(write_file(file, text).has_value());
  const auto resumed = RunJournal::resume(file, mission, false, UnderWay::Again);
  RC_ASSERT(resumed || !resumed.error().message.empty());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace segue::mission
