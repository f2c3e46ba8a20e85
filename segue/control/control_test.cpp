// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/request_codec.hpp>
#include <segue/rpc/detail/wire.hpp>

#include <support/fake_robot_service.hpp>
#include <support/random_values.hpp>

#include <capnp/message.h>
#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <future>
#include <thread>

namespace segue::control {
namespace {

using type::Value;

TEST_F(ControlTest, QuestionsAndAnswersTravel) {
  serve();
  const auto robot = client();
  EXPECT_EQ(robot->status().value(), Value::map({{"robot", "fake"}}));
  EXPECT_EQ(robot->task("slam").value(), Value::map({{"id", "slam"}}));
  EXPECT_EQ(robot->history().value(), Value(Value::List{}));
  EXPECT_EQ(robot->events(3, {}).value(), Value::list({Value::map({{"number", 4}})}));
  EXPECT_TRUE(robot->shut_down());
  EXPECT_TRUE(robot_.asked_to_end);
}

TEST_F(ControlTest, RequestsTravelWithAllTheirArguments) {
  serve();
  const auto robot = client();
  const auto switched = robot
                            ->diff("explore",
                                   {.order = model::Order::Paper,
                                    .action_deadline = std::chrono::seconds(3),
                                    .force = true,
                                    .who = "a test",
                                    .properties = {{model::TaskId("planner"), "speed.max", 0.5}},
                                    .lease = 7,
                                    .take_over = true},
                                   soon())
                            .value();
  EXPECT_EQ(*switched.find("to"), Value("explore"));
  EXPECT_EQ(*switched.find("dry_run"), Value(true));
  EXPECT_EQ(*switched.find("action_s"), Value(3.0));
  EXPECT_EQ(*robot->switch_to("explore", {}, soon()).value().find("dry_run"), Value(false));
  EXPECT_EQ(*switched.find("force"), Value(true));
  EXPECT_EQ(*switched.find("order"), Value("paper"));
  EXPECT_EQ(*switched.find("who"), Value("a test"));
  EXPECT_EQ(*switched.find("lease"), Value(7));
  EXPECT_EQ(*switched.find("take_over"), Value(true));
  EXPECT_EQ(*switched.find("properties"), Value::list({Value::list({"planner", "speed.max", 0.5})}));
  const double left = switched.find("left_s")->as_double();
  EXPECT_GT(left, 1.0);
  EXPECT_LE(left, std::chrono::duration<double>(kLong).count());
  EXPECT_EQ(
      robot->apply_transition({"restart", "transition: {}", "a.yaml"}, {.who = "a test"}, soon()).value(),
      Value::map({{"name", "restart"}, {"text", "transition: {}"}, {"file", "a.yaml"}, {"who", "a test"}}));
  EXPECT_EQ(robot->prepare({"drive", "dock"}, 0, soon()).value(), Value::list({"drive", "dock"}));
  EXPECT_EQ(robot->conflicts({"drive", "dock"}).value(), Value::list({"drive", "dock"}));
  EXPECT_TRUE(robot->write("planner", "goal", 7, {}, soon()));
  EXPECT_EQ(robot_.last_set(), Value::map({{"task", "planner"}, {"property", "port goal"}, {"value", 7}}));
}

TEST_F(ControlTest, RequestsForFilesAndNetworksTravelWithAllTheirArguments) {
  serve();
  const auto robot = client();
  EXPECT_EQ(robot->plan("explore", {.order = model::Order::Paper, .force = true}, soon()).value(),
            Value::map({{"to", "explore"}, {"force", true}, {"order", "paper"}}));
  EXPECT_EQ(
      robot
          ->apply(
              {.order = model::Order::Paper, .force = true, .who = "a test", .lease = 7, .take_over = true},
              soon())
          .value(),
      Value::map(
          {{"force", true}, {"order", "paper"}, {"who", "a test"}, {"lease", 7}, {"take_over", true}}));
  EXPECT_EQ(
      robot
          ->repair(
              {.order = model::Order::Paper, .force = true, .who = "a test", .lease = 7, .take_over = true},
              soon())
          .value(),
      Value::map({{"repaired", true}, {"who", "a test"}, {"lease", 7}, {"take_over", true}}));
  const auto sent = robot->diff_to_network(
      "tasks: {}", "n.yaml", {.order = model::Order::Paper, .force = true, .who = "a test"}, soon());
  EXPECT_EQ(sent.value(), Value::map({{"text", "tasks: {}"},
                                      {"file", "n.yaml"},
                                      {"dry_run", true},
                                      {"force", true},
                                      {"order", "paper"},
                                      {"who", "a test"},
                                      {"lease", 0},
                                      {"take_over", false},
                                      {"properties", Value::List{}}}));
  const std::string large(std::size_t{20} << 20, '#');
  const auto refused = robot->switch_to_network(large, "n.yaml", {}, soon());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ResourceExhausted);
}

TEST(RequestCodec, RefusesWordsAndPropertiesThatMeanNothing) {
  capnp::MallocMessageBuilder message;
  auto options = message.initRoot<wire::RequestOptions>();
  EXPECT_EQ(detail::decode(options.asReader(), Peer{}).value().order, model::Order::Seamless);
  options.setOrder("sideways");
  EXPECT_THAT(detail::decode(options.asReader(), Peer{}).error().message,
              ::testing::HasSubstr("no order 'sideways'"));
  options.setOrder("paper");
  for (const Value& wrong :
       {Value("speed"), Value::list({Value::map({{"task", "planner"}, {"value", 1}})})}) {
    ASSERT_TRUE(detail::encode(wrong, options.initProperties()));
    EXPECT_EQ(detail::decode(options.asReader(), Peer{}).error().code, ErrorCode::InvalidArgument);
  }
}

TEST_F(ControlTest, APropertyTravelsAsItWasWritten) {
  serve();
  const auto robot = client();
  Value version(1.1);
  version.set_source_text("1.10");
  ASSERT_TRUE(robot->set_property("a", "b.c", version, {}, soon()));
  EXPECT_EQ(robot_.last_set(), Value::map({{"task", "a"}, {"property", "b.c"}, {"value", 1.1}}));
  EXPECT_EQ(robot_.last_set_text(), "1.10");
  ASSERT_TRUE(robot->set_property("a", "b.c", 1, {"ann", 7, true}, soon()));
  EXPECT_EQ(robot_.last_sender().who, "ann");
  EXPECT_EQ(robot_.last_sender().lease, 7U);
  EXPECT_TRUE(robot_.last_sender().beside_mission);
  EXPECT_EQ(*robot->give_back(5, true, soon())->find("keep"), Value(true));
  EXPECT_EQ(*robot->give_back(5, true, soon())->find("lease"), Value(5));
  EXPECT_EQ(*robot->stop("ann", soon())->find("who"), Value("ann"));
  ASSERT_TRUE(robot->release_stop("bob"));
  EXPECT_EQ(*robot_.last_set().find("value"), Value("bob"));
}

TEST_F(ControlTest, UnitsAreShownAndSet) {
  serve();
  const auto robot = client();
  EXPECT_EQ(*robot->units(), Value::list({Value::map({{"name", "screws"}, {"count", 40}})}));
  EXPECT_EQ(robot->set_units("screws", 7, "ann").value(), 40U);
  EXPECT_EQ(robot_.last_set(), Value::map({{"task", "ann"}, {"property", "screws"}, {"value", 7}}));
}

TEST_F(ControlTest, ErrorsTravelWithPlaceAndCauses) {
  serve();
  const auto failed = client()->reset_belief("network: n", "n.yaml");
  EXPECT_EQ(robot_.last_set(), Value::map({{"network", "network: n"}, {"file", "n.yaml"}}));
  ASSERT_FALSE(failed);
  const Error& error = failed.error();
  EXPECT_EQ(error.code, ErrorCode::InvalidState);
  EXPECT_EQ(error.message, "the outermost");
  EXPECT_EQ(error.subject, "task_a");
  EXPECT_EQ(error.where, (SourceLocation{"outer.yaml", 1, 2}));
  ASSERT_TRUE(error.cause && error.cause->cause);
  EXPECT_EQ(error.cause->code, ErrorCode::HookFailed);
  EXPECT_EQ(error.cause->cause->where, (SourceLocation{"inner.yaml", 3, 4}));
  EXPECT_EQ(error.cause->cause->subject, "disk");
  EXPECT_EQ(error.cause->cause->cause, nullptr);
}

TEST_F(ControlTest, ADefectOfTheServiceIsAnErrorOfTheCall) {
  serve();
  const auto robot = client();
  const auto failed = robot->task("throws");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::Internal);
  EXPECT_NE(failed.error().message.find("a defect"), std::string::npos);
  EXPECT_TRUE(robot->status());
}

TEST_F(ControlTest, AnyValueComesBackAsItWent) {
  serve();
  const auto robot = client();
  rc::check("echo", [&] {
    const auto value = *type::random_value();
    const auto back = robot->call("t", "echo", value, {}, soon());
    RC_ASSERT(back.has_value());
    RC_ASSERT(*back == value);
    RC_ASSERT(back->kind() == value.kind());
  });
}

TEST_F(ControlTest, NumbersOfAKindComeBackAsThatKind) {
  serve();
  const auto robot = client();
  const Value mixed = Value::list({Value::list({1, 2, 3}), Value::list({1.5, 2.0}), Value::list({1, 2.0}),
                                   Value::list({UINT64_MAX, UINT64_MAX - 1}), Value(Value::List{})});
  const auto back = robot->call("t", "echo", mixed, {}, soon()).value();
  EXPECT_EQ(back, mixed);
  EXPECT_EQ(back.as_list()[1].as_list()[1].kind(), Value::Kind::Float);
  EXPECT_EQ(back.as_list()[2].as_list()[0].kind(), Value::Kind::Int);
  EXPECT_EQ(back.as_list()[3].as_list()[0].kind(), Value::Kind::UInt);
}

TEST_F(ControlTest, ValuesNestedTooDeepOrTooLargeAreRefusedAndTheConnectionLives) {
  serve();
  const auto robot = client();
  Value deep(1);
  for (int i = 0; i < 200; ++i)
    deep = Value::list({std::move(deep)});
  EXPECT_EQ(robot->call("t", "echo", deep, {}, soon()).value(), deep);
  for (int i = 0; i < 200; ++i)
    deep = Value::list({std::move(deep)});
  const auto too_deep = robot->call("t", "echo", deep, {}, soon());
  ASSERT_FALSE(too_deep);
  EXPECT_EQ(too_deep.error().code, ErrorCode::InvalidArgument);
  const auto too_large = robot->call("t", "echo", Value(std::string(std::size_t{20} << 20, 'x')), {}, soon());
  ASSERT_FALSE(too_large);
  EXPECT_EQ(too_large.error().code, ErrorCode::ResourceExhausted);
  EXPECT_EQ(robot->task("huge").error().code, ErrorCode::ResourceExhausted);
  EXPECT_TRUE(robot->status());
}

TEST_F(ControlTest, AnAnswerMayBeLargerThanWhatAServerTakes) {
  serve();
  const auto large = client()->task("large");
  ASSERT_TRUE(large) << to_string(large.error());
  EXPECT_EQ(large->as_string().size(), std::size_t{20} << 20);
}

TEST_F(ControlTest, SamplesOfAPortAreReadUntilTheReaderLeaves) {
  serve();
  const auto robot = client();
  auto stream = robot->open_port("source", "out", 10).value();
  EXPECT_EQ(stream->type_name(), "/int32_t");
  EXPECT_EQ(stream->read(2).value(), (std::vector<Value>{1, 2}));
  EXPECT_EQ(stream->read(1).value(), (std::vector<Value>{3}));
  EXPECT_EQ(robot_.open_streams, 1);
  EXPECT_EQ(robot->open_port("source", "no", 10).error().code, ErrorCode::NotFound);
  stream.reset();
  // The next stream's answer comes after the release of the last one was read.
  ASSERT_TRUE(robot->open_port("source", "out", 10));
  server_.reset();
  EXPECT_EQ(robot_.open_streams, 0);
}

TEST_F(ControlTest, NobodyWaitsForALookThatIsWantedNoLonger) {
  serve();
  const auto robot = client();
  const auto stream = robot->open_port("source", "out", 10).value();
  const auto lease = robot->lease("a test").value();
  std::stop_source stopped;
  stopped.request_stop();
  const Wait wait(soon(), stopped.get_token());
  EXPECT_EQ(robot->status(wait).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(robot->conflicts({}, wait).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(robot->open_port("source", "out", 10, wait).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(stream->read(1, wait).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(lease->standing(wait).error().code, ErrorCode::Cancelled);
}

TEST_F(ControlTest, ALookAtALeaseThatIsWantedNoLongerLosesNothingThatItsHolderWasAsked) {
  serve();
  const auto robot = client();
  const auto lease = robot->lease("a test").value();
  EXPECT_EQ(*robot->send_command("pause", {}), 1U);
  robot_.lease_blocks = true;
  std::stop_source stop;
  auto look = std::async(std::launch::async, [&] { return lease->standing({soon(), stop.get_token()}); });
  EXPECT_TRUE(robot_.entered.wait());
  stop.request_stop();
  EXPECT_EQ(look.get().error().code, ErrorCode::Cancelled);
  robot_.release.open();
  EXPECT_EQ(lease->asked().value(), (std::vector<HolderRequest>{{1, "pause", {}}}));
}

TEST_F(ControlTest, ALeaseEndsWithItsHolder) {
  serve();
  const auto robot = client();
  auto lease = robot->lease("a test").value();
  EXPECT_EQ(lease->number(), 7U);
  EXPECT_EQ(*robot->running(lease->number(), soon())->find("lease"), Value(7));
  EXPECT_EQ(lease->standing().value(), LeaseStanding());
  robot_.is_stopped = true;
  EXPECT_EQ(lease->standing().value(), (LeaseStanding{std::nullopt, true}));
  robot_.is_taken_over = true;
  EXPECT_EQ(lease->standing().value(), (LeaseStanding{"somebody", true}));
  const Value step = Value::map({{"how", "over"}});
  EXPECT_EQ(*robot->send_command("pause", {}), 1U);
  EXPECT_EQ(*robot->send_command("step", step), 2U);
  EXPECT_EQ(lease->standing().value().lost_to, "somebody") << "which keeps what is asked";
  EXPECT_EQ(lease->asked().value(), (std::vector<HolderRequest>{{1, "pause", {}}, {2, "step", step}}));
  EXPECT_EQ(lease->asked().value(), std::vector<HolderRequest>());
  EXPECT_TRUE(robot->report(lease->number(), "driving"));
  EXPECT_EQ(robot_.last_set(),
            Value::map({{"task", "lease 7"}, {"property", "doing"}, {"value", "driving"}}));
  EXPECT_EQ(robot->lease("another").error().message, "another is late");
  lease.reset();
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(robot->lease("the next")) << "the last has ended when its destructor returns";
}

TEST_F(ControlTest, CarriesWhatIsCancelledAndByWhom) {
  serve();
  const auto answer = client()->cancel(12, "ann", soon());
  ASSERT_TRUE(answer) << to_string(answer.error());
  EXPECT_EQ(*answer->find("request"), Value(12));
  EXPECT_EQ(*answer->find("who"), Value("ann"));
  EXPECT_GT(answer->find("left_s")->as_double(), 1.0);
}

TEST_F(ControlTest, CarriesQuestionsAboutThePast) {
  serve();
  const Value question = Value::map({{"ask", "at"}, {"time_s", 12.5}});
  EXPECT_EQ(client()->past(question).value(), question);
}

TEST_F(ControlTest, AMissionIsShown) {
  serve();
  EXPECT_EQ(client()->mission(12, true).value(), Value::map({{"after", 12}, {"with_plan", true}}));
}

TEST_F(ControlTest, ALeaseEndsWithTheConnectionOfItsHolder) {
  serve();
  auto robot = client();
  auto lease = robot->lease("a test").value();
  EXPECT_EQ(robot_.leases, 1);
  lease.reset();
  robot.reset();
  server_.reset();
  EXPECT_EQ(robot_.leases, 0);
}

TEST_F(ControlTest, AStreamMayOutliveItsClient) {
  serve();
  auto robot = client();
  const auto stream = robot->open_port("source", "out", 10).value();
  robot.reset();
  EXPECT_EQ(stream->read(1).value(), (std::vector<Value>{1}));
}

TEST_F(ControlTest, ASlowCallBlocksNeitherOthersNorItsOwnClient) {
  serve();
  const auto slow = client();
  const auto quick = client();
  auto waiting = std::async(std::launch::async, [&] { return slow->call("t", "wait", Value(), {}, soon()); });
  ASSERT_TRUE(robot_.entered.wait());
  EXPECT_TRUE(quick->status());
  EXPECT_TRUE(slow->status());
  robot_.release.open();
  EXPECT_EQ(waiting.get().value(), Value("released"));
}

TEST_F(ControlTest, ADeadlineThatPassesIsAnAnswer) {
  serve();
  const auto deadline = RealClock::instance().now() + std::chrono::milliseconds(20);
  const auto late = client()->call("t", "wait", Value(), {}, deadline);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_EQ(late.error().message, "nobody let me go");
}

TEST_F(ControlTest, WhoeverWaitsNoLongerIsNotAnsweredAndTheServiceLearnsIt) {
  serve();
  const auto robot = client();
  std::stop_source stop;
  auto waiting = std::async(std::launch::async, [&] {
    return robot->call("t", "wait", Value(), {}, {soon(), stop.get_token()});
  });
  ASSERT_TRUE(robot_.entered.wait());
  stop.request_stop();
  EXPECT_EQ(waiting.get().error().code, ErrorCode::Cancelled);
  EXPECT_TRUE(robot_.dropped.wait());
  robot_.release.open();
}

TEST_F(ControlTest, WhatIsWantedNoLongerIsNotSent) {
  serve();
  std::stop_source stop;
  stop.request_stop();
  const auto set = client()->set_property("t", "p", Value(1), {}, {soon(), stop.get_token()});
  EXPECT_EQ(set.error().code, ErrorCode::Cancelled);
  EXPECT_TRUE(robot_.last_set().is_null());
}

TEST_F(ControlTest, AClientWithTooManyCallsIsToldSo) {
  serve();
  const auto robot = client();
  std::vector<std::future<Result<Value>>> calls;
  for (int i = 0; i < 17; ++i) {
    calls.push_back(
        std::async(std::launch::async, [&] { return robot->call("t", "wait", Value(), {}, soon()); }));
  }
  // All but one wait; that one is refused at once.
  const auto other = client();
  EXPECT_TRUE(other->status());
  int refused = 0;
  for (bool found = false; !found;) {
    for (auto& call : calls)
      found |= call.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready;
  }
  robot_.release.open();
  for (auto& call : calls) {
    const auto answer = call.get();
    if (answer) continue;
    EXPECT_EQ(answer.error().code, ErrorCode::ResourceExhausted);
    ++refused;
  }
  EXPECT_EQ(refused, 1);
}

TEST_F(ControlTest, ManyClientsAndThreadsAtOnce) {
  serve();
  std::vector<std::future<int>> workers;
  for (int i = 0; i < 8; ++i) {
    workers.push_back(std::async(std::launch::async, [this, i] {
      const auto robot = client();
      int right = 0;
      for (int n = 0; n < 50; ++n) {
        const Value sent = Value::list({i, n});
        right += robot->call("t", "echo", sent, {}, soon()).value_or(Value()) == sent ? 1 : 0;
      }
      return right;
    }));
  }
  for (auto& worker : workers)
    EXPECT_EQ(worker.get(), 50);
}

TEST_F(ControlTest, AServerThatGoesAnswersTheCallInProgressAndIsGoneForTheNext) {
  serve();
  const auto robot = client();
  auto waiting =
      std::async(std::launch::async, [&] { return robot->call("t", "wait", Value(), {}, soon()); });
  ASSERT_TRUE(robot_.entered.wait());
  auto ending = std::async(std::launch::async, [&] { server_.reset(); });
  robot_.release.open();
  ending.get();
  EXPECT_EQ(waiting.get().value(), Value("released"));
  const auto after = robot->status();
  ASSERT_FALSE(after);
  EXPECT_EQ(after.error().code, ErrorCode::Unavailable);
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

TEST_F(ControlTest, WhoeverWaitsForEventsMayStop) {
  serve();
  const auto robot = client();
  std::stop_source stop;
  auto waiting = std::async(std::launch::async, [&] {
    return robot->events(10, Wait(Deadline(std::chrono::hours(1)), stop.get_token()));
  });
  ASSERT_TRUE(robot_.entered.wait());
  stop.request_stop();
  const auto answer = waiting.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::Cancelled);
  EXPECT_TRUE(robot_.dropped.wait());
  EXPECT_TRUE(robot->events(3, {})) << "the connection goes on";
}

TEST_F(ControlTest, AServerThatGoesDoesNotWaitForPatientClients) {
  serve();
  const auto robot = client();
  auto waiting = std::async(std::launch::async, [&] { return robot->events(10, std::chrono::hours(1)); });
  ASSERT_TRUE(robot_.entered.wait());
  const auto begun = RealClock::instance().now();
  server_.reset();
  EXPECT_LT(RealClock::instance().now() - begun, kLong);
  EXPECT_TRUE(waiting.get());
}

}  // namespace
}  // namespace segue::control
