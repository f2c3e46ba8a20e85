// SPDX-License-Identifier: Apache-2.0
#include <segue/remote_robot/test_support.hpp>

namespace segue::remote_robot {
namespace {

TEST_F(ServedRobotTest, RequestsInTheNameOfItsUserAndWithTheLease) {
  EXPECT_TRUE(robot_.request({{"explore", "arm"}, {{{"planner", "speed.max"}, 0.5, {}}}}, {}));
  EXPECT_EQ(service_.requested, "arm+explore");
  EXPECT_EQ(service_.options.who, "a test");
  EXPECT_EQ(service_.options.lease, 7U);
  EXPECT_EQ(service_.lease_holder, "a test");
  ASSERT_EQ(service_.options.properties.size(), 1U);
  EXPECT_EQ(service_.options.properties[0].task, model::TaskId("planner"));
  EXPECT_EQ(service_.options.properties[0].property, "speed.max");
}

TEST_F(ServedRobotTest, RequestsInTheNameOfTheActionsOfItsMission) {
  robot_.record().began("patrol");
  EXPECT_TRUE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_EQ(service_.options.who, "mission patrol");
  EXPECT_TRUE(robot_.request({{"explore", "arm"}, {}, {{"there", 0, "explore"}, {"work/up", 0, "arm"}}}, {}));
  EXPECT_EQ(service_.options.who, "mission patrol/there, patrol/work/up");
  mission::ControllerRequest many;
  for (int i = 0; i < 5; ++i)
    many.causes.push_back({std::to_string(i), 0, "explore"});
  EXPECT_TRUE(robot_.request(many, {}));
  EXPECT_EQ(service_.options.who, "mission patrol/0, patrol/1, patrol/2 and 2 more");
}

TEST_F(ServedRobotTest, ReportsWhatHappenedUntilTheRobotHasTakenIt) {
  robot_.record().began("patrol");
  service_.report_answer = fail(ErrorCode::Unavailable, "not now");
  EXPECT_FALSE(robot_.report(Value::map({{"mission", "patrol"}})));
  service_.report_answer = {};
  EXPECT_TRUE(robot_.request({{"explore"}, {}, {{"there", 0, "explore"}}}, {}));
  EXPECT_TRUE(robot_.report(Value::map({{"mission", "patrol"}})));
  const Value& doing = service_.reported.as_list()[1];
  EXPECT_EQ(*doing.find("mission"), Value("patrol"));
  const auto& entries = doing.find("happened")->find("entries")->as_list();
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(*entries[0].find("kind"), Value("began"));
  EXPECT_EQ(*entries[1].find("controller"), Value("explore"));
  EXPECT_TRUE(robot_.report(Value::map({{"mission", "patrol"}})));
  EXPECT_EQ(service_.reported.as_list()[1].find("happened"), nullptr);
}

TEST_F(ServedRobotTest, TellsOfUnitsUntilTheRobotHasTakenIt) {
  service_.kept_units = Value::list({Value::map({{"name", "screws"}, {"count", 40}})});
  EXPECT_EQ(*robot_.counts(), (mission::UnitCounts{{"screws", 40}}));
  ASSERT_TRUE(robot_.begin("1234", {{"screws", 40}}));
  EXPECT_EQ(service_.reported.as_list()[1],
            Value::map(
                {{"units", Value::map({{"run", "journal 1234"}, {"begun", Value::map({{"screws", 40}})}})}}));
  robot_.changed({"drill", 2, "0.1"}, {{"screws", -2}});
  service_.report_answer = fail(ErrorCode::Unavailable, "not now");
  EXPECT_FALSE(robot_.tell_units());
  EXPECT_TRUE(robot_.has_units_to_tell());
  service_.report_answer = {};
  EXPECT_TRUE(robot_.tell_units());
  EXPECT_FALSE(robot_.has_units_to_tell());
  const Value& told = *service_.reported.as_list()[1].find("units");
  EXPECT_EQ(*told.find("run"), Value("journal 1234"));
  EXPECT_EQ(
      *told.find("changes"),
      Value::list({Value::map({{"execution", "drill#2:0.1"}, {"units", Value::map({{"screws", -2}})}})}));
}

TEST_F(ServedRobotTest, TellsApartWhatARunWithoutAJournalDoes) {
  const auto told = [&] { return *service_.reported.as_list()[1].find("units"); };
  ASSERT_TRUE(robot_.begin("", {}));
  const Value run = *told().find("run");
  robot_.changed({"drill"}, {{"screws", -2}});
  robot_.changed({"drill"}, {{"screws", 2}});  // a step back
  ASSERT_TRUE(robot_.begin("", {}));
  EXPECT_NE(*told().find("run"), run);
  robot_.changed({"drill"}, {{"screws", -3}});
  EXPECT_TRUE(robot_.tell_units());
  EXPECT_EQ(*told().find("run"), run) << "first those of the run before";
  const Value before = told();
  const auto& changes = before.find("changes")->as_list();
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_NE(*changes[0].find("execution"), *changes[1].find("execution"));
  EXPECT_TRUE(robot_.tell_units());
  EXPECT_NE(*told().find("run"), run);
  EXPECT_FALSE(robot_.has_units_to_tell());
}

TEST_F(ServedRobotTest, SumsUpWhatLookAheadSaved) {
  EXPECT_TRUE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_EQ(robot_.saved(), LookAheadSaving{}) << "nothing was prepared";
  service_.switch_answer =
      Value::map({{"outcome", "done"}, {"ahead", Value::map({{"tasks", 2}, {"saved_s", 0.5}})}});
  EXPECT_TRUE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_TRUE(robot_.request({{"arm"}, {}}, {}));
  EXPECT_EQ(robot_.saved(), (LookAheadSaving{2, std::chrono::seconds(1)}));
}

TEST_F(ServedRobotTest, ReportsWhyAControllerDoesNotRun) {
  service_.switch_answer = Value::map({{"outcome", "refused"}, {"error", "no such controller"}});
  const auto refused = robot_.request({{"explore"}, {}}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "the request for controller 'explore' was refused: no such controller");
  service_.switch_answer = Value::map({{"outcome", "superseded"}});
  EXPECT_EQ(robot_.request({}, {}).error().code, ErrorCode::Superseded);
}

TEST_F(ServedRobotTest, SeesWhetherAControllerRunsAsItShould) {
  EXPECT_EQ(robot_.trouble("explore", soon())->why, "");
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "the robot runs controller 'explore'");
  service_.status_answer = Value::map({{"controller", "arm+drive"}});
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "");
  EXPECT_EQ(robot_.trouble("driv", soon())->why, "the robot runs controller 'arm+drive'");
  service_.status_answer = Value::map({{"controller", ""}});
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "the robot runs the empty network");
  const Value fault =
      Value::map({{"fault", "task 'a' failed still"}, {"controllers", Value::list({"drive"})}});
  service_.status_answer = Value::map({{"controller", "arm+drive"}, {"unresolved", Value::list({fault})}});
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "task 'a' failed still");
  EXPECT_EQ(robot_.trouble("arm", soon())->why, "") << "it runs on";
  const Value broken = Value::map(
      {{"fault", "task 'b' is broken"}, {"controllers", Value::list({"arm"})}, {"task", Value("b")}});
  service_.status_answer =
      Value::map({{"controller", "arm+drive"}, {"unresolved", Value::list({broken, fault})}});
  EXPECT_TRUE(robot_.trouble("drive", soon())->tasks.empty());
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "task 'a' failed still");
  ASSERT_EQ(robot_.trouble("arm", soon())->tasks.size(), 1U);
  EXPECT_EQ(robot_.trouble("arm", soon())->tasks.front().id, "b");
  EXPECT_EQ(robot_.trouble("arm", soon())->why, "");
}

TEST_F(ServedRobotTest, SeesWhetherAControllerIsBeingRepaired) {
  const Value fault = Value::map({{"fault", "process 'p' is gone"}, {"controllers", Value::list({"drive"})}});
  service_.status_answer = Value::map({{"controller", "arm+drive"}, {"in_repair", Value::list({fault})}});
  EXPECT_EQ(robot_.trouble("drive", soon())->repair, "process 'p' is gone");
  EXPECT_EQ(robot_.trouble("drive", soon())->why, "");
  EXPECT_EQ(robot_.trouble("arm", soon())->repair, "");
}

TEST_F(ServedRobotTest, SeesWhichInstancesOfPoolsWork) {
  const auto instance = [](const char* task, bool busy) {
    return Value::map({{"task", task}, {"ready", true}, {"pid", 7}, {"busy", busy}});
  };
  service_.status_answer = Value::map(
      {{"pools", Value::list({Value::map({{"pool", "planner"},
                                          {"most", 3},
                                          {"instances", Value::list({instance("planner_1", true),
                                                                     instance("planner_2", false)})}})})}});
  const auto pools = robot_.pools(soon());
  ASSERT_TRUE(pools);
  EXPECT_TRUE(pools->at(0).instances.at(0).busy);
  EXPECT_FALSE(pools->at(0).instances.at(1).busy);
  EXPECT_EQ(pools->at(0).most, 3U);
}

TEST_F(ServedRobotTest, GetsInstancesOfPools) {
  const auto taken =
      answer_to<model::TakenInstance>(soon(), [&](const Wait& wait, model::InstanceAnswer answer) {
        robot_.take_instance({"planner", {"planner_2", 8}}, wait, std::move(answer));
      });
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->task, "planner_1 rather than planner_2");
  EXPECT_EQ(taken->pid, 9);
}

TEST_F(ServedRobotTest, NoticesThatTheRobotWasTakenOver) {
  EXPECT_TRUE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_EQ(robot_.trouble("explore", soon())->why, "");
  service_.standing.lost_to = "segue switch";
  EXPECT_EQ(robot_.trouble("explore", soon())->why, "the robot was taken over by segue switch");
  service_.switch_answer = Value::map({{"outcome", "superseded"}, {"error", "a newer request came"}});
  const auto refused = robot_.request({{"explore"}, {}}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_EQ(refused.error().message, "the robot was taken over by segue switch");
}

TEST_F(ServedRobotTest, SaysThatItsMissionIsStoppedBeforeAnythingFails) {
  int stopped = 0;
  robot_.when_stopped([&] { ++stopped; });
  EXPECT_TRUE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_EQ(robot_.trouble("explore", soon())->why, "");
  EXPECT_EQ(stopped, 0);
  service_.standing.is_stopped = true;
  EXPECT_EQ(robot_.trouble("explore", soon())->why, "the mission is stopped");
  EXPECT_EQ(stopped, 1);
  EXPECT_FALSE(robot_.set({"wheels", "speed"}, 1, {})) << "which this robot cannot do anyhow";
  EXPECT_EQ(stopped, 2);
  service_.switch_answer = Value::map({{"outcome", "refused"}, {"error", "the mission is being stopped"}});
  EXPECT_FALSE(robot_.request({{"explore"}, {}}, {}));
  EXPECT_EQ(stopped, 3);
}

TEST_F(ServedRobotTest, KnowsWhatCannotRunAtOnce) {
  service_.status_answer = Value::map({{"controllers", Value::list({"a", "b"})}});
  service_.conflicts_answer =
      Value::list({Value::map({{"a", "a"}, {"b", "b"}, {"what", "task arm"}, {"influence", false}}),
                   Value::map({{"a", "b"}, {"b", "a"}, {"what", "input x.y"}, {"influence", true}})});
  const auto conflicts = robot_.conflicts(soon());
  ASSERT_TRUE(conflicts);
  EXPECT_EQ(conflicts->controllers, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(conflicts->conflict("b", "a"));
  EXPECT_FALSE(conflicts->conflict("a", "a"));
  EXPECT_TRUE(conflicts->influence("b", "a"));
  EXPECT_FALSE(conflicts->influence("a", "b"));
}

TEST_F(ServedRobotTest, SaysWhatItsUserDoesAndHearsWhatThatIsAsked) {
  EXPECT_TRUE(robot_.take());
  EXPECT_EQ(service_.lease_holder, "a test");
  EXPECT_EQ(robot_.asked()->front().what, "pause");
  EXPECT_TRUE(robot_.report("driving"));
  EXPECT_EQ(service_.reported, Value::list({std::uint64_t{7}, "driving"}));
}

TEST_F(ServedRobotTest, WritesToPorts) {
  EXPECT_TRUE(robot_.write({"planner", "goal"}, 7, {}));
  EXPECT_EQ(service_.sent_with, 0U) << "nothing has taken the lease yet";
  ASSERT_TRUE(robot_.take());
  EXPECT_TRUE(robot_.write({"planner", "goal"}, 7, {}));
  EXPECT_NE(service_.sent_with, 0U);
  EXPECT_TRUE(robot_.give_back(true, TimePoint()));
  EXPECT_EQ(service_.given_back.as_list().back(), type::Value(true));
  EXPECT_FALSE(robot_.take()) << "it has been given back";
  EXPECT_FALSE(robot_.write({"planner", "goal"}, 8, {})) << "not as somebody without a lease either";
  EXPECT_EQ(service_.written, Value::list({"planner", "goal", 7}));
}

TEST_F(ServedRobotTest, IsLostWhereItDoesNotSayInTimeWhatItRuns) {
  ASSERT_TRUE(robot_.take());
  service_.running_error = fail(ErrorCode::DeadlineExceeded, "robot 'spot' did not answer within 10s");
  EXPECT_EQ(robot_.trouble("explore", soon()).error().code, ErrorCode::DeadlineExceeded);
  EXPECT_TRUE(robot_.asked()) << "the deadline was that of who asked";
  const auto trouble = robot_.trouble("explore", Wait(TimePoint::max()));
  ASSERT_FALSE(trouble);
  EXPECT_EQ(trouble.error().code, ErrorCode::Unavailable);
  EXPECT_EQ(trouble.error().message, "robot 'spot' did not answer within 10s, and counts as lost");
  service_.running_error.reset();
  EXPECT_FALSE(robot_.trouble("explore", soon())) << "for good";
  EXPECT_FALSE(robot_.write({"planner", "goal"}, 7, {}));
  EXPECT_TRUE(service_.written.is_null());
  EXPECT_FALSE(robot_.asked());
  EXPECT_FALSE(robot_.give_back(false, TimePoint())) << "it would not be heard";
  EXPECT_TRUE(service_.given_back.is_null());
}

TEST_F(ServedRobotTest, ThatIsLostIsWaitedForByNobody) {
  ASSERT_TRUE(robot_.take());
  service_.switch_waits = true;
  auto request = std::async(std::launch::async, [&] {
    return robot_.request({{"explore"}, {}}, RealClock::instance().now() + std::chrono::seconds(60));
  });
  service_.switches.get_future().wait();
  service_.lease_answer.error = fail(ErrorCode::DeadlineExceeded, "it is silent");
  EXPECT_FALSE(robot_.asked());
  EXPECT_EQ(request.get().error().message, "it is silent, and counts as lost");
}

TEST_F(ServedRobotTest, ThatIsSilentIsWaitedForOnce) {
  ASSERT_TRUE(robot_.take());
  std::promise<void> begun;
  std::promise<void> silent;
  service_.lease_answer.error = fail(ErrorCode::DeadlineExceeded, "it is silent");
  service_.lease_answer.begun = &begun;
  service_.lease_answer.wait = &silent;
  auto first = std::async(std::launch::async, [&] { return robot_.asked(); });
  begun.get_future().wait();
  auto second = std::async(std::launch::async, [&] { return robot_.asked(); });
  silent.set_value();
  EXPECT_FALSE(first.get());
  EXPECT_EQ(second.get().error().message, "it is silent, and counts as lost");
  EXPECT_FALSE(robot_.set({"wheels", "speed"}, 1, soon()));
  EXPECT_EQ(service_.lease_answer.looks, 0);
}

TEST_F(ServedRobotTest, ThatIsSilentIsLookedAtNoLongerThanWanted) {
  std::promise<void> begun;
  service_.status_waits = &begun;
  std::stop_source stop;
  auto trouble = std::async(std::launch::async, [&] {
    return robot_.trouble("explore", {soon(), stop.get_token()});
  });
  begun.get_future().wait();
  stop.request_stop();
  EXPECT_EQ(trouble.get().error().code, ErrorCode::Cancelled);
}

TEST_F(ServedRobotTest, WhoseLeaseIsLookedAtByOthersIsWaitedForNoLongerThanWanted) {
  ASSERT_TRUE(robot_.take());
  std::promise<void> begun;
  std::promise<void> silent;
  service_.lease_answer.begun = &begun;
  service_.lease_answer.wait = &silent;
  auto first = std::async(std::launch::async, [&] { return robot_.asked(); });
  begun.get_future().wait();
  std::stop_source stop;
  auto second = std::async(std::launch::async, [&] {
    return robot_.set({"wheels", "speed"}, 1, {soon(), stop.get_token()});
  });
  stop.request_stop();
  EXPECT_EQ(second.get().error().code, ErrorCode::Unsupported)
      << "what it was answered, and nothing was waited for";
  silent.set_value();
  EXPECT_TRUE(first.get());
}

TEST_F(ServedRobotTest, CountsChangesUntilItIsLost) {
  ASSERT_TRUE(robot_.take());
  std::optional<Result<std::uint64_t>> count;
  const auto answered = [&](Result<std::uint64_t> answer) { count = std::move(answer); };
  robot_.changes(0, Wait(TimePoint::max()), answered);
  ASSERT_TRUE(count);
  EXPECT_EQ(**count, 7U);
  count.reset();
  robot_.changes(7, Wait(TimePoint::max()), answered);
  EXPECT_FALSE(count || service_.changes_wait.stop_requested());
  service_.lease_answer.error = fail(ErrorCode::DeadlineExceeded, "it is silent");
  EXPECT_FALSE(robot_.asked());
  EXPECT_TRUE(service_.changes_wait.stop_requested());
  robot_.changes(7, Wait(TimePoint::max()), answered);
  ASSERT_TRUE(count);
  EXPECT_EQ(count->error().message, "it is silent, and counts as lost");
}

TEST_F(ServedRobotTest, HasControllersPreparedUnderItsLease) {
  ASSERT_TRUE(robot_.take());
  EXPECT_TRUE(robot_.prepare({"explore"}, {}));
  EXPECT_EQ(service_.prepared, std::vector<std::string>{"explore"});
  EXPECT_EQ(service_.sent_with, 7U);
  EXPECT_TRUE(robot_.give_back(false, TimePoint()));
  EXPECT_FALSE(robot_.prepare({"arm"}, {})) << "nor as somebody without a lease";
  EXPECT_EQ(service_.prepared, std::vector<std::string>{"explore"});
}

TEST_F(ServedRobotTest, SeesTasks) {
  service_.level_answer = control::RobotLevel{{TaskState::Running, "arrived", 7}, 4};
  const auto task = robot_.task("planner", RealClock::instance().now() + std::chrono::seconds(60));
  ASSERT_TRUE(task);
  EXPECT_EQ(service_.watched.task, model::TaskId("planner"));
  EXPECT_EQ(service_.watched.seen, std::nullopt);
  EXPECT_EQ(task->state, "running");
  EXPECT_EQ(task->state_name, "arrived");
  EXPECT_EQ(task->updates, 7U);
  EXPECT_EQ(task->changes, 4U);
}

TEST_F(ServedRobotTest, AsksForWhatIsNotAsItWasSeen) {
  robot_.watch({"planner", mission::TaskView{"running", "driving", 3}, true}, {}, [](const auto&) {});
  EXPECT_EQ(service_.watched.seen, (task_host::TaskLevel{TaskState::Running, "driving", 3}));
  EXPECT_TRUE(service_.watched.each_update);
}

}  // namespace
}  // namespace segue::remote_robot
