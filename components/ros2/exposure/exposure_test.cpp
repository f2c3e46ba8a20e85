// SPDX-License-Identifier: Apache-2.0
#include "exposure_test_support.hpp"

#include <segue/task/realtime_log.hpp>

#include <support/logged_lines.hpp>

#include <future>

namespace ros2::testing {
namespace {

TEST_P(ExposedTasks, AreNodesAsLongAsTheRobotHasThem) {
  robot->add_task("front.camera");
  robot->add_task("topic", "ros2::Subscription");  // is a node itself
  expose();
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/drive", "/robot/front_camera"}));
  robot->remove_task("drive");
  robot->add_task("arm");
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/arm", "/robot/front_camera"}));
  ASSERT_TRUE(exposure->task().stop(soon()));
  EXPECT_TRUE(are_nodes({"/exposure"}));
  ASSERT_TRUE(exposure->task().start(soon()));
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/arm", "/robot/front_camera"}));
}

TEST_P(ExposedTasks, AreThoseThatAPatternNames) {
  robot->add_task("arm_left");
  robot->add_task("arm_right");
  ValueMap more;
  more.set("tasks", Value::list({"arm_*"}));
  expose(false, more);
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/arm_left", "/robot/arm_right"}));
}

TEST_P(ExposedTasks, HaveTheirPropertiesAsParameters) {
  expose();
  auto list = asker("/robot/drive/list_parameters", "rcl_interfaces/srv/ListParameters");
  const Value result = *list.ask(Value::map({})).find("result");
  EXPECT_EQ(*result.find("names"),
            Value::list({"speed", "count", "name", "on", "gains.p", "gains.limits", "offsets"}))
      << "points and huge have no counterpart";
  EXPECT_EQ(*result.find("prefixes"), Value::list({"gains"}));
  const Value below =
      *list.ask(Value::map({{"prefixes", Value::list({"gains"})}, {"depth", 1}})).find("result");
  EXPECT_EQ(*below.find("names"), Value::list({"gains.p", "gains.limits"}));

  auto get = asker("/robot/drive/get_parameters", "rcl_interfaces/srv/GetParameters");
  const Value got = get.ask(names({"speed", "gains.limits", "missing", "on"}));
  const auto& values = got.find("values")->as_list();
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(*values[0].find("double_value"), Value(0.5));
  EXPECT_EQ(*values[1].find("integer_array_value"), Value::list({1, 2}));
  EXPECT_EQ(*values[2].find("type"), Value(0));
  EXPECT_EQ(*values[3].find("bool_value"), Value(true));

  auto types = asker("/robot/drive/get_parameter_types", "rcl_interfaces/srv/GetParameterTypes");
  EXPECT_EQ(*types.ask(names({"speed", "count", "name", "offsets", "missing"})).find("types"),
            Value::list({3, 2, 4, 8, 0}));
}

TEST_P(ExposedTasks, SayWhichParametersAreReadOnly) {
  for (const bool writable : {false, true}) {
    expose(writable);
    auto describe = asker("/robot/drive/describe_parameters", "rcl_interfaces/srv/DescribeParameters");
    const Value response = describe.ask(names({"speed", "count"}));
    const auto& all = response.find("descriptors")->as_list();
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(*all[0].find("description"), Value("the speed"));
    EXPECT_EQ(*all[0].find("read_only"), Value(!writable));
    EXPECT_EQ(*all[1].find("read_only"), Value(true)) << "it is not live";
    EXPECT_EQ(*all[1].find("additional_constraints"), Value("in milliseconds"));
    exposure.reset();
  }
}

TEST_P(ExposedTasks, HaveTheStatesOfManagedNodes) {
  expose();
  auto get = asker("/robot/drive/get_state", "lifecycle_msgs/srv/GetState");
  const auto state_is = [&](int id, const char* label) {
    return eventually([&] {
      return *get.ask(Value::map({})).find("current_state") == Value::map({{"id", id}, {"label", label}});
    });
  };
  EXPECT_TRUE(state_is(3, "active"));
  robot->set_state("drive", TaskState::Stopped);
  EXPECT_TRUE(state_is(2, "inactive"));
  robot->set_state("drive", TaskState::PreOperational);
  EXPECT_TRUE(state_is(1, "unconfigured"));
  robot->set_state("drive", TaskState::Exception);
  EXPECT_TRUE(state_is(15, "errorprocessing"));
  robot->set_state("drive", TaskState::RunTimeError);
  EXPECT_TRUE(state_is(3, "active")) << "it goes on";
}

TEST_P(ExposedTasks, TellOfChangesOfTheirStates) {
  expose();
  peer->subscribe(
      {.topic = "/robot/drive/transition_event", .interface = "lifecycle_msgs/msg/TransitionEvent"});
  segue::ros2::InterfaceLibrary library;
  const auto codec = segue::ros2::MessageCodec::of(library, "lifecycle_msgs/msg/TransitionEvent").value();
  std::vector<std::int64_t> goals;
  const auto take = [&] {
    for (const Bytes& message : peer->take())
      goals.push_back(codec.decode(message).value().find("goal_state")->find("id")->as_int());
  };
  // The subscription gets nothing before the publisher has found it, which nobody is told.
  ASSERT_TRUE(eventually([&] {
    for (const TaskState state : {TaskState::Stopped, TaskState::Running})
      robot->set_state("drive", state);
    take();
    return !goals.empty();
  }));
  for (const TaskState state : {TaskState::PreOperational, TaskState::Exception, TaskState::Running}) {
    robot->set_state("drive", state);
    const std::int64_t goal = state == TaskState::PreOperational ? 1 : state == TaskState::Exception ? 15 : 3;
    EXPECT_TRUE(eventually([&] {
      take();
      return goals.back() == goal;
    }));
  }
  const std::vector<std::int64_t> last(goals.end() - std::min<std::ptrdiff_t>(5, std::ssize(goals)),
                                       goals.end());
  EXPECT_THAT(last, ElementsAre(1, 15, 1, 2, 3)) << "a node comes from an error through all states";
}

TEST_P(ExposedTasks, DoNotChangeTheirStatesForClients) {
  segue::testing::LoggedLines lines;
  expose(true);
  auto change = asker("/robot/drive/change_state", "lifecycle_msgs/srv/ChangeState");
  EXPECT_EQ(*change.ask(Value::map({{"transition", Value::map({{"id", 4}})}})).find("success"), Value(false));
  segue::task::RealtimeLog::instance().drain();
  EXPECT_TRUE(lines.has({"another state of task 'drive'", "use `segue switch CONTROLLER`"}));
  auto offered =
      asker("/robot/drive/get_available_transitions", "lifecycle_msgs/srv/GetAvailableTransitions");
  EXPECT_EQ(offered.ask(Value::map({})).find("available_transitions")->as_list().size(), 0U);
  auto graph = asker("/robot/drive/get_transition_graph", "lifecycle_msgs/srv/GetAvailableTransitions");
  EXPECT_GE(graph.ask(Value::map({})).find("available_transitions")->as_list().size(), 4U);
  auto states = asker("/robot/drive/get_available_states", "lifecycle_msgs/srv/GetAvailableStates");
  EXPECT_EQ(states.ask(Value::map({})).find("available_states")->as_list().size(), 11U);
}

TEST_P(ExposedTasks, AreNotWrittenUnlessThatIsPermitted) {
  expose();
  const Value result = first_result(setter().ask(parameters({speed(2.0)})));
  EXPECT_EQ(*result.find("successful"), Value(false));
  EXPECT_THAT(result.find("reason")->as_string(), HasSubstr("set the property 'writable'"));
  EXPECT_EQ(robot->property("drive", "speed"), Value(0.5));
}

TEST_P(ExposedTasks, HaveTheirLivePropertiesSet) {
  expose(true);
  const Value response = setter().ask(parameters(
      {speed(2.0), parameter("count", 2, "integer_value", 5), parameter("missing", 1, "bool_value", true)}));
  const auto& results = response.find("results")->as_list();
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(*results[0].find("successful"), Value(true));
  EXPECT_THAT(results[1].find("reason")->as_string(), HasSubstr("segue switch CONTROLLER --set drive.count"));
  EXPECT_THAT(results[2].find("reason")->as_string(), HasSubstr("no property 'missing'"));
  EXPECT_EQ(robot->property("drive", "speed"), Value(2.0));
  EXPECT_EQ(robot->property("drive", "count"), Value(3));
  ASSERT_EQ(robot->senders().size(), 1U);
  EXPECT_EQ(robot->senders().front().who, "ROS 2, by task exposure");
  EXPECT_EQ(robot->senders().front().lease, 0U);
  EXPECT_FALSE(robot->senders().front().beside_mission) << "who holds the lease is not disturbed";
}

TEST_P(ExposedTasks, SayWhyTheRobotRefusesAParameter) {
  robot->on_set = [](const std::string&) {
    return segue::Result<void>(
        segue::fail(segue::ErrorCode::InvalidState, "mission 'tidy' commands the robot"));
  };
  expose(true);
  const Value result = first_result(setter().ask(parameters({speed(2.0)})));
  EXPECT_EQ(*result.find("successful"), Value(false));
  EXPECT_THAT(result.find("reason")->as_string(), HasSubstr("mission 'tidy' commands the robot"));
}

TEST_P(ExposedTasks, AreSetAllTogetherOrNotAtAll) {
  robot->on_set = [](const std::string& property) {
    return property == "name"
               ? segue::Result<void>(segue::fail(segue::ErrorCode::InvalidArgument, "too long"))
               : segue::Result<void>();
  };
  expose(true);
  auto set = asker("/robot/drive/set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically");
  const Value response = set.ask(parameters({speed(2.0), parameter("name", 4, "string_value", "right")}));
  EXPECT_EQ(*response.find("result")->find("successful"), Value(false));
  EXPECT_THAT(response.find("result")->find("reason")->as_string(), HasSubstr("too long"));
  EXPECT_EQ(robot->property("drive", "speed"), Value(0.5)) << "it is set back";
  EXPECT_EQ(robot->senders().size(), 2U);
}

TEST_P(ExposedTasks, OfferOperationsWithoutArgumentsWherePermitted) {
  robot->add_task("arm");
  expose(true);
  EXPECT_EQ(asker("/robot/drive/reset", "std_srvs/srv/Trigger").ask(Value::map({})),
            Value::map({{"success", true}, {"message", "\"reset is done\""}}));
  const Value failed = asker("/robot/arm/reset", "std_srvs/srv/Trigger").ask(Value::map({}));
  EXPECT_EQ(*failed.find("success"), Value(false));
  EXPECT_THAT(failed.find("message")->as_string(), HasSubstr("the wheels are stuck"));
}

TEST_P(ExposedTasks, HaveWhatTheyLogOnRosout) {
  robot->log("the battery is low");
  expose();
  read_rosout();
  segue::ros2::InterfaceLibrary library;
  const auto codec = segue::ros2::MessageCodec::of(library, "rcl_interfaces/msg/Log").value();
  Texts lines;
  EXPECT_TRUE(eventually([&] {
    // A line that came before the subscription was there has left the topic after 10 s.
    robot->log("the battery is low");
    for (const Bytes& message : peer->take()) {
      const Value line = codec.decode(message).value();
      lines.push_back(std::to_string(line.find("level")->as_int()) + " " + line.find("name")->as_string() +
                      ": " + line.find("msg")->as_string());
    }
    return std::ranges::find(lines, "30 robot.drive: the battery is low") != lines.end();
  })) << ::testing::PrintToString(lines);
}

/// Whoever keeps few lines loses them otherwise.
TEST_P(ExposedTasks, TellTheirLinesOneAfterTheOther) {
  constexpr int kLines = 20;
  expose();
  read_rosout();
  const auto lines_with = [this, found = 0](const std::string& text) mutable {
    for (const Bytes& message : peer->take()) {
      const std::string line(reinterpret_cast<const char*>(message.data()), message.size());
      found += line.find(text) != std::string::npos ? 1 : 0;
    }
    return found;
  };
  // Nothing is asked for while nobody reads.
  ASSERT_TRUE(eventually([&, read = lines_with]() mutable {
    robot->log("is it read?");
    return read("is it read?") > 0;
  }));
  robot->log("the last of these");
  ASSERT_TRUE(eventually([read = lines_with]() mutable { return read("the last of these") == 1; }));
  robot->log("many", kLines);
  ASSERT_TRUE(eventually([read = lines_with]() mutable { return read("many") == kLines; }));
  EXPECT_GE(segue::monotonic_now() - *robot->told(), (kLines - 1) * std::chrono::milliseconds(5));
}

TEST_P(ExposedTasks, AreNoNodesAfterTheRobotHasEnded) {
  expose();
  ASSERT_TRUE(are_nodes({"/exposure", "/robot/drive"}));
  end_robot();
  EXPECT_TRUE(are_nodes({"/exposure"}));
  EXPECT_TRUE(eventually([&] { return state() == TaskState::RunTimeError; }));
  serve();
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/drive"}));
  EXPECT_TRUE(eventually([&] { return state() == TaskState::Running; }));
}

TEST_P(ExposedTasks, AnswerThoughOneVanishesWhileItIsSet) {
  hold_sets();
  expose(true);
  auto set = setter();
  const auto number = set.send(parameters({speed(2.0)}));
  ASSERT_TRUE(robot->entered.wait_until(soon()));
  robot->remove_task("drive");
  robot->add_task("arm");
  EXPECT_TRUE(are_nodes({"/exposure", "/robot/arm"})) << "whoever is asked something holds up no switch";
  robot->release.open();
  auto get = asker("/robot/arm/get_state", "lifecycle_msgs/srv/GetState");
  EXPECT_EQ(*get.ask(Value::map({})).find("current_state")->find("label"), Value("active"));
  EXPECT_TRUE(robot->senders().empty()) << number;
}

TEST_P(ExposedTasks, AreNotWaitedForWhereTheyDoNotAnswerAtTheStop) {
  robot->silence("drive");
  expose();
  auto get = asker("/robot/drive/get_parameters", "rcl_interfaces/srv/GetParameters");
  ASSERT_TRUE(get.has_server());
  const auto client = segue::control::connect(segue::control::socket_path("fake").value()).value();
  auto question = std::async(std::launch::async, [&] { return client->task("drive"); });
  ASSERT_TRUE(robot->entered.wait_until(soon()));
  get.send(names({"speed"}));
  ASSERT_TRUE(eventually([&] { return robot->reports == 2; }));
  ASSERT_TRUE(exposure->task().stop(soon()));
  EXPECT_EQ(question.wait_for(std::chrono::seconds(0)), std::future_status::timeout)
      << "who has asked before that waits still";
  robot->release.open();
  EXPECT_TRUE(question.get());
}

TEST_P(ExposedTasks, DropMalformedRequestsAndThoseThatAreTooMany) {
  robot->add_task("arm");
  hold_sets();
  expose(true);
  auto get = asker("/robot/arm/get_parameters", "rcl_interfaces/srv/GetParameters");
  const Bytes header = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  Bytes lies = header;
  for (int i = 0; i < 20; ++i)
    lies.push_back(std::byte{0xff});
  for (const Bytes& bytes : {header, lies, Bytes(3)}) {
    if (GetParam() == Middleware::FastDds || bytes.size() > 3) get.send_bytes(bytes);
  }
  EXPECT_TRUE(eventually([&] { return exposure->count("corrupt") >= 2; }));
  auto set = setter();
  set.send(parameters({speed(2.0)}));
  ASSERT_TRUE(robot->entered.wait_until(soon()));
  for (int i = 0; i < 1000; ++i)
    set.send(parameters({speed(2.0)}));
  EXPECT_TRUE(eventually([&] { return exposure->count("dropped") > 0; })) << "a hundred wait for one task";
  EXPECT_EQ(*get.ask(names({"on"})).find("values")->as_list().front().find("bool_value"), Value(true))
      << "other tasks answer";
  robot->release.open();
}

TEST_P(ExposedTasks, DoNotWaitForAClientThatHasLeft) {
  robot->add_task("arm");
  hold_sets();
  expose(true);
  {
    auto leaves = setter();
    leaves.send(parameters({speed(2.0)}));
    ASSERT_TRUE(robot->entered.wait_until(soon()));
  }
  robot->release.open();
  auto get = asker("/robot/drive/get_state", "lifecycle_msgs/srv/GetState");
  EXPECT_EQ(*get.ask(Value::map({})).find("current_state")->find("label"), Value("active"));
  // Its response goes nowhere, whether it was known by then that the client has left or not.
  EXPECT_TRUE(eventually([&] { return exposure->count("responses") + exposure->count("unsent") == 2; }));
  EXPECT_EQ(robot->property("drive", "speed"), Value(2.0));
}

TEST_P(ExposedTasks, AreUnreachableWhereTheRobotIsNotThere) {
  end_robot();
  expose();
  EXPECT_TRUE(eventually([&] { return state() == TaskState::RunTimeError; }));
  EXPECT_EQ(exposure->count("nodes"), 0U);
}

INSTANTIATE_TEST_SUITE_P(, ExposedTasks, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(ExposureProperties, AreChecked) {
  RunningTask exposure("ros2::Exposure", "exposure");
  ValueMap map;
  const auto unknown = exposure.configure(map);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(segue::to_string(unknown.error()), HasSubstr("set the property 'robot'"));
  map.set("robot", "fake");
  map.set("namespace", "1st floor");
  const auto wrong = exposure.configure(map);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(segue::to_string(wrong.error()), HasSubstr("namespace: '1st floor' is not valid"));
}

}  // namespace
}  // namespace ros2::testing
