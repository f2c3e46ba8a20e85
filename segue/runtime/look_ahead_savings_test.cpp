// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_reader.hpp>
#include <segue/runtime/look_ahead_savings.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

/// The time that look-ahead saves, measured.
namespace segue::runtime {
namespace {

using namespace std::chrono_literals;

constexpr const char* kCruise = R"(
network: cruise
tasks: {base: {component: x::Base}}
)";
/// One task in a process of its own takes long, the other, which waits for nobody, longer.
constexpr const char* kPark = R"(
network: park
tasks:
  base: {component: x::Base}
  camera: {component: x::Camera, properties: {stand_in: {configure: 80ms}}}
  servo: {component: x::Servo, properties: {stand_in: {configure: 200ms}}}
deployments:
  d: {host: localhost, process: vision, tasks: [camera, servo]}
connections: [camera.image -> servo.image, servo.command -> base.command]
)";

class SavedByLookAhead : public ::testing::Test {
 protected:
  explicit SavedByLookAhead(RuntimeOptions options = {}) : robot_(std::move(options)) {
    EXPECT_FALSE(runtime_.add_controller(testing::network_of(kCruise)).has_errors());
    EXPECT_FALSE(runtime_.add_controller(testing::network_of(kPark)).has_errors());
    EXPECT_EQ(switch_to("cruise").outcome, Outcome::Done);
  }
  SwitchResult switch_to(const char* name) { return runtime_.switch_to(model::NetworkName(name)); }
  void prepare(std::vector<model::NetworkName> names) {
    for (const auto& one : runtime_.prepare(std::move(names)).get())
      EXPECT_TRUE(one.ready) << one.reason;
  }

  testing::StandInRobot robot_;
  Runtime& runtime_ = robot_.runtime;
};

TEST_F(SavedByLookAhead, IsWhatPreparingHadTakenAhead) {
  prepare({model::NetworkName("park")});
  const auto parked = switch_to("park");
  ASSERT_EQ(parked.outcome, Outcome::Done) << parked.why();
  ASSERT_TRUE(parked.ahead);
  EXPECT_EQ(parked.ahead->tasks, 2U) << "the third ran already";
  EXPECT_GE(parked.ahead->unprepared, 200ms) << "both are configured at once";
  EXPECT_LT(parked.ahead->unprepared, 60s);
  const auto value = to_value(parked);
  const auto* ahead = value.find("ahead");
  ASSERT_NE(ahead, nullptr);
  EXPECT_EQ(ahead->find("tasks")->as_uint(), 2U);
  EXPECT_GE(ahead->find("unprepared_s")->as_double(), ahead->find("saved_s")->as_double());
}

TEST_F(SavedByLookAhead, IsNothingWhereNothingWasPrepared) {
  EXPECT_EQ(switch_to("park").ahead, std::nullopt);
  EXPECT_EQ(switch_to("cruise").ahead, std::nullopt);
  prepare({model::NetworkName("cruise")});
  EXPECT_EQ(switch_to("cruise").ahead, std::nullopt) << "it runs";
}

TEST_F(SavedByLookAhead, IsWhatItHadTakenBeforeWhereItStaysPrepared) {
  EXPECT_EQ(switch_to("park").outcome, Outcome::Done);
  prepare({model::NetworkName("park")});
  EXPECT_EQ(switch_to("cruise").outcome, Outcome::Done);
  const auto again = switch_to("park");
  ASSERT_TRUE(again.ahead) << "its tasks were kept when it ended";
  EXPECT_GE(again.ahead->unprepared, 200ms);
}

TEST(LookAheadSavings, LearnNothingFromActionsThatFailed) {
  const testing::StandInRobot robot;
  const model::TaskId servo("servo");
  detail::BeforeTransition before;
  before.controller = testing::network_of(kCruise);
  before.current = testing::network_of(kPark);
  for (const char* id : {"camera", "servo"})
    before.current.find_task(model::TaskId(id))->state = TaskState::Stopped;
  before.standby.tasks.push_back(*before.current.find_task(servo));
  ActionRecord configured;
  configured.action = {1, model::ActionKind::Configure, model::TaskAction{servo}, model::Phase::Prepare, {}};
  configured.executed = true;
  configured.took = 200ms;
  ActionRecord failed = configured;
  failed.took = 1ns;
  failed.error = fail(ErrorCode::HookFailed, "no servo answers");
  detail::LookAheadSavings savings;
  for (const auto& record : {configured, failed}) {
    SwitchResult executed;
    executed.actions = {record};
    savings.learn(executed);
  }
  const auto park = testing::network_of(kPark);
  const auto ahead = savings.of({}, before, {park, park, {}}, robot.host, robot.catalog, {});
  ASSERT_TRUE(ahead);
  EXPECT_EQ(ahead->tasks, 1U);
  EXPECT_GE(ahead->unprepared, 200ms);
}

class SavedInJournal : public SavedByLookAhead {
 protected:
  SavedInJournal() : SavedByLookAhead(options()) {}
  ~SavedInJournal() override { std::filesystem::remove_all(folder()); }
  static const std::filesystem::path& folder() {
    static const std::filesystem::path made = [] {
      std::string pattern = ::testing::TempDir() + "segue-savings-XXXXXX";
      EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
      return std::filesystem::path(pattern);
    }();
    return made;
  }
  static RuntimeOptions options() {
    RuntimeOptions options;
    options.journal = folder() / "journal.sqlite";
    return options;
  }
};

TEST_F(SavedInJournal, StandsBesideWhatItTook) {
  prepare({model::NetworkName("park")});
  const auto parked = switch_to("park");
  ASSERT_TRUE(parked.ahead);
  ASSERT_TRUE(runtime_.served().flush_journal(RealClock::instance().now() + 60s));
  auto reader = journal::JournalReader::open(options().journal);
  ASSERT_TRUE(reader) << to_string(reader.error());
  const auto entries = reader->transitions(1);
  ASSERT_TRUE(entries && !entries->empty());
  EXPECT_EQ(entries->front().request, parked.request);
  EXPECT_EQ(entries->front().ahead, parked.ahead);
  EXPECT_EQ(entries->front().prepare, parked.prepare);
}

}  // namespace
}  // namespace segue::runtime
