// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <support/fake_deployment.hpp>
#include <support/random_actions.hpp>

#include <rapidcheck.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <future>
#include <map>
#include <optional>
#include <thread>

namespace segue::control {
namespace {

using model::ActionKind;
using model::TaskId;
using type::Value;

TEST_F(DeploymentTest, WhoItIsTravels) {
  deployment_.who.robot = "spot";
  deployment_.who.deployment.process = model::ProcessName("p");
  deployment_.who.deployment.limits.memory = 5;
  deployment_.who.pid = 42;
  deployment_.who.software = "9.9";
  deployment_.who.incarnation = UINT64_MAX;
  serve();
  const auto info = client()->info().value();
  EXPECT_EQ(info.robot, "spot");
  EXPECT_EQ(info.deployment, deployment_.who.deployment);
  EXPECT_EQ(info.pid, 42);
  EXPECT_EQ(info.software, "9.9");
  EXPECT_EQ(info.incarnation, UINT64_MAX);
}

TEST_F(DeploymentTest, NetworksAndTransitionsTravel) {
  serve();
  const auto process = client();
  rc::check("round trip", [&](std::uint64_t seed) {
    segue::testing::Random random(seed);
    const auto transition = segue::testing::random_transition(random);
    const auto network = segue::testing::random_network(random, segue::testing::everything());
    deployment_.hold(network);
    RC_ASSERT(process->expect(network).has_value());
    RC_ASSERT(deployment_.seen()->expected == network);
    RC_ASSERT(process->snapshot().value().network == network);
    RC_ASSERT(process->conclude(transition, soon()).has_value());
    RC_ASSERT(deployment_.seen()->concluded == transition);
    RC_ASSERT(process->perform_all(transition.actions, soon()).size() == transition.actions.size());
    RC_ASSERT(transition.actions.empty() || deployment_.seen()->performed == transition.actions);
  });
}

TEST_F(DeploymentTest, ABatchHasAnOutcomeForEachAction) {
  serve();
  const std::vector<model::Action> actions = {action_of(ActionKind::Stop, "a"),
                                              action_of(ActionKind::Stop, "bad"),
                                              action_of(ActionKind::Start, "c")};
  const auto outcomes = client()->perform_all(actions, soon());
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_TRUE(outcomes[0]);
  EXPECT_TRUE(outcomes[2]);
  ASSERT_FALSE(outcomes[1]);
  EXPECT_EQ(outcomes[1].error().code, ErrorCode::HookFailed);
  EXPECT_EQ(outcomes[1].error().subject, "bad");
  EXPECT_EQ(deployment_.seen()->performed, actions);
  EXPECT_GT(deployment_.seen()->left, std::chrono::seconds(1));
  EXPECT_LE(deployment_.seen()->left, kLong);
  EXPECT_TRUE(client()->perform_all({}, soon()).empty());
}

/// Collects the ends that a batch reports.
struct ReportedEnds {
  task_host::Completion listener() {
    return [this](const std::vector<task_host::Completed>& ended) {
      const Lock lock(mutex);
      for (const auto& one : ended) {
        EXPECT_FALSE(outcomes.contains(one.index)) << "reported twice";
        outcomes.insert_or_assign(one.index, one.outcome);
      }
    };
  }
  std::size_t count() {
    const Lock lock(mutex);
    return outcomes.size();
  }
  bool has(std::size_t index) {
    const Lock lock(mutex);
    return outcomes.contains(index);
  }
  Mutex mutex;
  std::map<std::size_t, Result<void>> outcomes;
};

TEST_F(DeploymentTest, HowLongActionsTookTravels) {
  serve();
  Mutex mutex;
  std::map<std::size_t, std::optional<Duration>> took;
  const auto process = client();
  process->begin_all({action_of(ActionKind::Stop, "a"), action_of(ActionKind::Stop, "bad")}, soon(),
                     [&](const std::vector<task_host::Completed>& ended) {
                       const Lock lock(mutex);
                       for (const auto& one : ended)
                         took.emplace(one.index, one.took);
                     });
  ASSERT_TRUE(eventually([&] {
    const Lock lock(mutex);
    return took.size() == 2;
  }));
  for (const auto& [index, duration] : took) {
    ASSERT_TRUE(duration);
    EXPECT_GE(*duration, Duration(0));
    EXPECT_LT(*duration, kLong);
  }
}

TEST_F(DeploymentTest, WhatEndsWhileAnotherActionIsSlowIsToldEarly) {
  serve();
  const auto process = client();
  const auto begin = [&](ReportedEnds& reported) {
    process->begin_all({action_of(ActionKind::Stop, "a"), action_of(ActionKind::Stop, "wait"),
                        action_of(ActionKind::Stop, "bad"), action_of(ActionKind::Stop, "c")},
                       soon(), reported.listener());
  };
  ReportedEnds one;
  ReportedEnds other;
  begin(one);
  begin(other);
  EXPECT_TRUE(eventually([&] { return one.count() == 3 && other.count() == 3; }));
  EXPECT_FALSE(one.has(1));
  EXPECT_EQ(one.outcomes.at(2).error().code, ErrorCode::HookFailed);
  EXPECT_TRUE(process->info()) << "others are answered meanwhile";
  deployment_.release.open();
  EXPECT_TRUE(eventually([&] { return one.count() == 4 && other.count() == 4; }));
  EXPECT_TRUE(one.outcomes.at(1));
}

TEST_F(DeploymentTest, AServerThatGoesInTheMiddleOfABatchTellsItsEnd) {
  serve();
  ReportedEnds reported;
  const auto process = client();
  process->begin_all({action_of(ActionKind::Stop, "a"), action_of(ActionKind::Stop, "wait")}, soon(),
                     reported.listener());
  EXPECT_TRUE(eventually([&] { return reported.count() == 1; }));
  std::thread end([&] { server_.reset(); });
  deployment_.release.open();
  end.join();
  EXPECT_TRUE(eventually([&] { return reported.count() == 2; }));
  EXPECT_TRUE(reported.outcomes.at(1)) << to_string(reported.outcomes.at(1).error());
}

TEST_F(DeploymentTest, AServiceThatThrowsIsAnErrorOfEachAction) {
  serve();
  const auto outcomes = client()->perform_all(
      std::vector{action_of(ActionKind::Stop, "a"), action_of(ActionKind::Stop, "throws")}, soon());
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].error().code, ErrorCode::Internal);
  EXPECT_NE(outcomes[1].error().message.find("a defect"), std::string::npos);
}

Result<task_host::TaskLevel> level_of(deploy::DeploymentService& process, const char* task) {
  return answer_to<task_host::TaskLevel>(soon(), [&](const Wait& wait, task_host::LevelAnswer answered) {
    process.watch({TaskId(task)}, wait, std::move(answered));
  });
}

TEST_F(DeploymentTest, TasksAreLookedAtAndSet) {
  deployment_.component.name = model::ComponentName("demo::A");
  deployment_.component.ports.push_back({"out", model::Direction::Output, "/int32_t", true, false, "doc"});
  deployment_.task_details.timing.updates.counts[3] = 7;
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  EXPECT_EQ(process->describe(TaskId("a")).value(), deployment_.component);
  EXPECT_EQ(process->details(TaskId("a"))->timing, deployment_.task_details.timing);
  Value version(1.1);
  version.set_source_text("1.10");
  ASSERT_TRUE(process->set_property(TaskId("a"), "b.c", version, soon()));
  EXPECT_EQ(deployment_.seen()->written, "a.b.c");
  EXPECT_EQ(deployment_.seen()->value.source_text(), "1.10");
  EXPECT_EQ(process->properties(TaskId("a")).value(), version);
  EXPECT_EQ(process->properties(TaskId("no")).error().code, ErrorCode::NotFound);
  EXPECT_EQ(process->call(TaskId("a"), "echo", Value::list({1, "x"}), soon()).value(), Value::list({1, "x"}));
  EXPECT_EQ(level_of(*process, "a")->state, TaskState::Running);
  EXPECT_EQ(level_of(*process, "a")->state_name, "idle");
  EXPECT_EQ(level_of(*process, "no").error().code, ErrorCode::NotFound);
  EXPECT_EQ(process->details(TaskId("no")).error().code, ErrorCode::NotFound);
  const auto thrown = process->describe(TaskId("throws"));
  ASSERT_FALSE(thrown);
  EXPECT_NE(thrown.error().message.find("a defect"), std::string::npos);
}

/// A question that waits for a change of a task.
class DeploymentWatch {
 public:
  void ask(deploy::DeploymentService& process, const task_host::TaskLevel& seen,
           TimePoint deadline = soon()) {
    question_.ask(deadline, [&](const Wait& wait, task_host::LevelAnswer answered) {
      process.watch({TaskId("a"), seen}, wait, std::move(answered));
    });
  }
  /// DeadlineExceeded where none comes.
  Result<task_host::TaskLevel> answer() {
    while (true) {
      if (auto answer = question_.take()) return std::move(*answer);
      if (RealClock::instance().now() >= soon_) return fail(ErrorCode::DeadlineExceeded, "no answer");
      bell_->wait(soon_);
    }
  }

 private:
  const TimePoint soon_ = soon();
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  Question<task_host::TaskLevel> question_{bell_};
};

TEST_F(DeploymentTest, WhoHasSeenATaskHearsOnceItChanges) {
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  const auto seen = level_of(*process, "a");
  ASSERT_TRUE(seen);
  DeploymentWatch watch;
  watch.ask(*process, *seen);
  deployment_.become("driving");
  EXPECT_EQ(watch.answer()->state_name, "driving");
}

TEST_F(DeploymentTest, WhoSeesATaskUnchangedHearsAtTheDeadline) {
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  DeploymentWatch watch;
  watch.ask(*process, {TaskState::Running, "idle", 7},
            RealClock::instance().now() + std::chrono::milliseconds(10));
  EXPECT_EQ(watch.answer()->state_name, "idle");
}

TEST_F(DeploymentTest, MoreTasksAreWatchedThanTheServerHasThreads) {
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  std::vector<DeploymentWatch> watches(200);
  for (DeploymentWatch& watch : watches)
    watch.ask(*process, {TaskState::Running, "idle", 7});
  EXPECT_EQ(level_of(*process, "a")->state_name, "idle");
  deployment_.become("driving");
  for (DeploymentWatch& watch : watches)
    EXPECT_EQ(watch.answer()->state_name, "driving");
}

TEST_F(DeploymentTest, AQuestionThatIsDroppedIsDroppedInTheProcess) {
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  {
    DeploymentWatch watch;
    watch.ask(*process, {TaskState::Running, "idle", 7});
    EXPECT_TRUE(level_of(*process, "a"));  // so the question has arrived before it
  }
  EXPECT_TRUE(deployment_.dropped.wait());
}

TEST_F(DeploymentTest, WhoWatchesATaskOfAProcessThatEndsHearsThatItIsGone) {
  deployment_.state_name = "idle";
  serve();
  const auto process = client();
  DeploymentWatch watch;
  watch.ask(*process, {TaskState::Running, "idle", 7});
  EXPECT_TRUE(level_of(*process, "a"));
  server_.reset();
  EXPECT_EQ(watch.answer().error().code, ErrorCode::Unavailable);
}

TEST_F(DeploymentTest, WhatTasksRememberTravels) {
  serve();
  const auto process = client();
  const auto nothing = process->save_state(TaskId("a"), soon());
  ASSERT_TRUE(nothing) << to_string(nothing.error());
  EXPECT_FALSE(nothing->has_value());
  const task::SavedState state{"/demo/State", 7, Value::map({{"x", Value::list({1, 2.5, "three"})}})};
  ASSERT_TRUE(process->restore_state(TaskId("a"), state, soon()));
  EXPECT_EQ(process->save_state(TaskId("a"), soon()).value(), state);
  EXPECT_EQ(process->save_state(TaskId("no"), soon()).error().code, ErrorCode::NotFound);
  EXPECT_EQ(process->restore_state(TaskId("no"), state, soon()).error().code, ErrorCode::NotFound);
  const task::SavedState huge{"/demo/State", 1, Value(std::string(std::size_t{64} << 20, 'x'))};
  EXPECT_EQ(process->restore_state(TaskId("a"), huge, soon()).error().code, ErrorCode::ResourceExhausted);
  EXPECT_TRUE(process->info()) << "the connection lives";
}

TEST_F(DeploymentTest, SamplesOfAPortAreReadUntilTheReaderLeaves) {
  serve();
  const auto process = client();
  auto reader = process->open_reader({TaskId("a"), "out"}, 10).value();
  EXPECT_EQ(reader->type_name(), "/int32_t");
  EXPECT_EQ(reader->read(2), (std::vector<Value>{11, 12}));
  EXPECT_EQ(process->open_reader({TaskId("a"), "no"}, 10).error().code, ErrorCode::NotFound);
  EXPECT_EQ(deployment_.open_readers, 1);
  reader.reset();
  EXPECT_TRUE(eventually([&] { return deployment_.open_readers == 0; }));
  reader = process->open_reader({TaskId("a"), "out"}, 10).value();
  server_.reset();
  EXPECT_EQ(deployment_.open_readers, 0);
  EXPECT_TRUE(reader->read(1).empty());
}

TEST_F(DeploymentTest, SamplesOfAPortAreWaitedFor) {
  serve();
  const auto process = client();
  const auto reader = process->open_reader({TaskId("a"), "out"}, 10).value();
  const auto next = [&] {
    std::promise<Result<std::vector<Value>>> answered;
    reader->next(2, Wait(soon()), [&](auto samples) { answered.set_value(std::move(samples)); });
    return answered.get_future().get();
  };
  EXPECT_EQ(next().value(), (std::vector<Value>{11, 12}));
  EXPECT_EQ(next().value(), (std::vector<Value>{13, 14}));
  server_.reset();
  EXPECT_EQ(next().error().code, ErrorCode::Unavailable);
}

TEST_F(DeploymentTest, ConnectionsBetweenProcessesAreArranged) {
  deployment_.place = {1, 2, 3, true, "/Pose", 4, "definition", "b.in"};
  serve();
  const auto process = client();
  const std::vector<model::PortRef> ports = {{TaskId("a"), "out"}, {TaskId("a"), "no"}};
  const auto origins = process->describe_outputs(ports, soon());
  ASSERT_EQ(origins.size(), 2U);
  EXPECT_EQ(std::tuple(origins[0]->writer, origins[0]->sample_size, origins[0]->flat),
            std::tuple(7U, 3U, true));
  EXPECT_EQ(origins[1].error().code, ErrorCode::NotFound);

  const model::Connection connection{ports[0], {TaskId("b"), "in"}, {BufferKind::Buffer, 9}, {}};
  const auto places =
      process->open_inputs(std::vector<deploy::OpenInput>{{connection, {8, 16, true}}}, soon());
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0]->definition, "definition");
  ASSERT_EQ(deployment_.seen()->opened.size(), 1U);
  EXPECT_EQ(deployment_.seen()->opened[0].connection, connection);
  EXPECT_EQ(deployment_.seen()->opened[0].origin.writer, 8U);

  ASSERT_TRUE(
      process->attach_outputs(std::vector<deploy::AttachOutput>{{connection, *places[0]}}, soon()).at(0));
  EXPECT_EQ(deployment_.seen()->attached.at(0).place.generation, 3U);
  const std::vector<deploy::CloseEndpoint> endpoints = {{connection, deploy::Side::Input, true, 5},
                                                        {connection, deploy::Side::Output, false, 6}};
  EXPECT_EQ(process->close_endpoints(endpoints, soon()).size(), 2U);
  EXPECT_TRUE(deployment_.seen()->closed.at(0).peer_closed);
  EXPECT_EQ(deployment_.seen()->closed.at(0).peer, 5U);
  EXPECT_EQ(deployment_.seen()->closed.at(1).peer, 6U);
  EXPECT_EQ(deployment_.seen()->closed.at(1).side, deploy::Side::Output);
  ASSERT_TRUE(process->forget(77));
  EXPECT_EQ(deployment_.seen()->forgotten, 77U);
}

TEST_F(DeploymentTest, MemoryArrivesAndNoDescriptorIsLeftBehind) {
  serve();
  const auto process = client();
  ASSERT_TRUE(process->info());
  const std::size_t before = open_descriptors();
  for (int i = 0; i < 50; ++i) {
    const auto offer = process->memory(soon());
    ASSERT_TRUE(offer) << to_string(offer.error());
    EXPECT_EQ(offer->incarnation, 7U);
    EXPECT_EQ(content_of(offer->payload), "payload");
    EXPECT_EQ(content_of(offer->control), "control");
    const sample_link::MemoryOffer own{9, memory_with("mine"), memory_with("too")};
    ASSERT_TRUE(process->admit(own, soon()));
    EXPECT_EQ(deployment_.seen()->admitted, (std::vector<std::string>{"9", "mine", "too"}));
  }
  EXPECT_TRUE(eventually([&] { return open_descriptors() == before; })) << open_descriptors() - before;
}

TEST_F(DeploymentTest, EventsComeInOrderToAllWhoListen) {
  serve();
  const auto process = client();
  const auto other = client();
  std::atomic<int> first{0};
  std::atomic<int> second{0};
  std::atomic<bool> in_order{true};
  process->set_listener([&](const task_host::TaskEvent& event) {
    if (event.task.str() != "t" + std::to_string(first++) || event.state != TaskState::Fatal)
      in_order = false;
  });
  other->set_listener([&](const task_host::TaskEvent&) { ++second; });
  for (int i = 0; i < 1000; ++i)
    deployment_.tell({TaskId("t" + std::to_string(i)), TaskState::Fatal, "message"});
  EXPECT_TRUE(eventually([&] { return first == 1000 && second == 1000; })) << first << " " << second;
  EXPECT_TRUE(in_order);
}

TEST_F(DeploymentTest, AListenerThatDoesNotKeepUpLosesTheOldestAndBlocksNobody) {
  serve();
  const auto slow = client();
  const auto quick = client();
  Gate go_on;
  std::atomic<int> got{0};
  std::atomic<int> newest{-1};
  slow->set_listener([&](const task_host::TaskEvent& event) {
    go_on.wait();
    ++got;
    newest = std::stoi(event.message);
  });
  constexpr int kEvents = 30'000;
  for (int i = 0; i < kEvents; ++i) {
    deployment_.tell({TaskId("t"), TaskState::Exception, std::to_string(i)});
    if (i % 1000 == 0) {
      ASSERT_TRUE(quick->info());
    }
  }
  go_on.open();
  EXPECT_TRUE(eventually([&] { return newest == kEvents - 1; })) << newest;
  EXPECT_LT(got, kEvents);
}

TEST_F(DeploymentTest, NoEventComesAfterTheListenerIsTakenAway) {
  serve();
  const auto process = client();
  std::atomic<bool> reported{false};
  process->set_listener([&](const task_host::TaskEvent&) { reported = true; });
  deployment_.tell({TaskId("t"), TaskState::Fatal, ""});
  EXPECT_TRUE(eventually([&] { return reported.load(); }));
  process->set_listener(nullptr);
  reported = false;
  deployment_.tell({TaskId("t"), TaskState::Fatal, ""});
  ASSERT_TRUE(process->info());
  ASSERT_TRUE(process->info());
  EXPECT_FALSE(reported);
}

}  // namespace
}  // namespace segue::control
