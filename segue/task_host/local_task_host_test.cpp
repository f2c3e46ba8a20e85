// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task_host/test_support.hpp>

#include <gmock/gmock.h>

#include <future>
#include <memory>
#include <semaphore>
#include <thread>

namespace segue::task_host {
namespace {

using model::ActionKind;
using testing::apply;
using ::testing::HasSubstr;
using testing::on_connection;
using testing::on_process;
using testing::on_task;
using testing::soon;
using testing::task_of;
using testing::wire;

class LocalHost : public ::testing::Test {
 protected:
  Result<void> perform(const model::Action& action) { return host_.perform(action, soon()); }
  void expect_done(const model::Action& action) {
    const auto done = perform(action);
    EXPECT_TRUE(done) << to_string(done.error());
  }
  void expect_refused(const model::Action& action, ErrorCode code, std::string_view words) {
    const model::Network before = host_.observe();
    const auto done = perform(action);
    ASSERT_FALSE(done) << action.label();
    EXPECT_EQ(done.error().code, code) << to_string(done.error());
    EXPECT_THAT(to_string(done.error()), HasSubstr(words));
    EXPECT_FALSE(done.error().subject.empty());
    EXPECT_TRUE(equivalent(before, host_.observe())) << "a refused action changes nothing";
  }
  void bring_to_running(std::string_view id) {
    expect_done(apply(task_of(id, "any::Thing")));
    expect_done(on_task(ActionKind::Configure, id));
    expect_done(on_task(ActionKind::Start, id));
  }
  TaskState state_of(std::string_view id) {
    const auto network = host_.observe();
    const auto* task = network.find_task(model::TaskId(id));
    return task == nullptr ? TaskState::Fatal : task->state;
  }

  model::ComponentCatalog catalog_;
  LibrarySet libraries_;
  LocalTaskHost host_{libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
};

TEST_F(LocalHost, TellsTheTimingAndTheLogOfOneTask) {
  bring_to_running("a");
  bring_to_running("b");
  ASSERT_TRUE(task::RealtimeLog::instance().push(LogLevel::Warning, "a", "too warm"));
  ASSERT_TRUE(task::RealtimeLog::instance().push(LogLevel::Warning, "b", "too cold"));
  const auto details = host_.details(model::TaskId("a"));
  ASSERT_TRUE(details) << to_string(details.error());
  ASSERT_FALSE(details->log.empty());
  EXPECT_EQ(details->log.back().message, "too warm");
  EXPECT_EQ(details->log.back().level, LogLevel::Warning);
  expect_done(on_task(ActionKind::Stop, "a"));
  for (const TaskReport& report : host_.tasks()) {
    if (report.id.str() != "a") continue;
    EXPECT_EQ(host_.details(report.id)->timing.updates.total(), report.timing.cycles);
  }
  EXPECT_EQ(host_.details(model::TaskId("x")).error().code, ErrorCode::NotFound);
}

TEST_F(LocalHost, TellsTheLogOfATaskWithALongName) {
  const std::string name(task::RealtimeLog::kSourceBytes + 20, 'n');
  bring_to_running(name);
  ASSERT_TRUE(task::RealtimeLog::instance().push(LogLevel::Info, name, "here"));
  EXPECT_EQ(host_.details(model::TaskId(name))->log.size(), 1U);
}

TEST_F(LocalHost, RefusesVerbsThatTheStateDoesNotAllow) {
  expect_done(apply(task_of("a", "any::Thing")));
  for (const auto kind : {ActionKind::Start, ActionKind::Stop, ActionKind::Cleanup, ActionKind::Recover}) {
    expect_refused(on_task(kind, "a"), ErrorCode::InvalidState, "pre_operational");
  }
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_refused(on_task(ActionKind::Configure, "a"), ErrorCode::InvalidState, "stopped");
}

TEST_F(LocalHost, RefusesActionsOnTasksAndProcessesThatAreNotThere) {
  bring_to_running("velodyne");
  for (const auto kind : {ActionKind::Recover, ActionKind::Stop, ActionKind::Cleanup, ActionKind::Configure,
                          ActionKind::Start}) {
    expect_refused(on_task(kind, "velodyme"), ErrorCode::NotFound, "did you mean 'velodyne'");
  }
  expect_refused(on_process(ActionKind::Undeploy, "p"), ErrorCode::NotFound, "not deployed");
  expect_refused(apply(task_of("b", "any::Thing"), "p"), ErrorCode::InvalidState, "deploy it first");
  model::Action call{1, ActionKind::CallOperation, model::CallAction{model::TaskId("x"), "go", {}}, {}, {}};
  expect_refused(call, ErrorCode::NotFound, "no task 'x'");
  call.what = model::CallAction{model::TaskId("velodyne"), "go", {}};
  expect_refused(call, ErrorCode::NotFound, "go");
}

TEST_F(LocalHost, KeepsProcessesAndTheTasksInThem) {
  expect_done(on_process(ActionKind::Deploy, "p"));
  expect_refused(on_process(ActionKind::Deploy, "p"), ErrorCode::AlreadyExists, "already deployed");
  expect_refused(on_process(ActionKind::Deploy, ""), ErrorCode::InvalidArgument, "needs a name");
  expect_done(apply(task_of("a", "any::Thing"), "p"));
  expect_done(on_task(ActionKind::Configure, "a"));
  const auto seen = host_.observe();
  ASSERT_EQ(seen.deployments.size(), 1U);
  ASSERT_EQ(seen.deployments.front().tasks.size(), 1U);
  EXPECT_EQ(seen.deployments.front().tasks.front().task, model::TaskId("a"));
  expect_refused(on_process(ActionKind::Undeploy, "p"), ErrorCode::InvalidState, "stopped");
  expect_refused(apply(task_of("a", "any::Thing")), ErrorCode::InvalidState, "clean it up first");
  expect_done(on_task(ActionKind::Cleanup, "a"));
  expect_done(on_process(ActionKind::Undeploy, "p"));
  EXPECT_TRUE(host_.observe().empty());
}

TEST_F(LocalHost, ConnectsOnceAndDisconnectsWhatIsConnected) {
  bring_to_running("a");
  bring_to_running("b");
  const auto connection = wire("a", "out", "b", "in");
  expect_refused(on_connection(ActionKind::Disconnect, connection), ErrorCode::NotFound, "not connected");
  expect_done(on_connection(ActionKind::Connect, connection));
  expect_refused(on_connection(ActionKind::Connect, connection), ErrorCode::AlreadyExists,
                 "already connected");
  EXPECT_EQ(host_.observe().connections, std::vector{connection});
  expect_refused(on_connection(ActionKind::Connect, wire("a", "out", "c", "in")), ErrorCode::NotFound, "'c'");
  expect_done(on_connection(ActionKind::Disconnect, connection));
  EXPECT_TRUE(host_.connections().empty());
  auto shared = connection;
  shared.policy.transport = Transport::SharedMemory;
  expect_refused(on_connection(ActionKind::Connect, shared), ErrorCode::Unsupported, "inside one process");
}

/// Of a process that is killed while actions on its tasks are carried out, nothing remains.
TEST_F(LocalHost, EndsNoConnectionAtTheCommitOfATransitionThatWasGivenUp) {
  bring_to_running("a");
  bring_to_running("b");
  expect_done(on_connection(ActionKind::Connect, wire("a", "out", "b", "in")));
  auto ending = on_connection(ActionKind::Disconnect, wire("a", "out", "b", "in"));
  ending.phase = model::Phase::Retire;
  model::Transition given_up;
  given_up.order = model::Order::Seamless;
  given_up.actions.push_back(ending);
  ASSERT_TRUE(host_.arm_commit(given_up, soon()));
  host_.withdraw();
  // One where nothing waits for the commit.
  ASSERT_TRUE(host_.arm_commit({}, soon()));
  ASSERT_TRUE(host_.commit());
  EXPECT_EQ(host_.observe().connections.size(), 1U);
}

TEST_F(LocalHost, ForgetsTheTasksAndConnectionsOfAProcessThatDiesDuringActions) {
  auto kill = on_process(ActionKind::Undeploy, "p");
  std::get<model::DeploymentAction>(kill.what).kill = true;
  const auto connection = wire("a", "out", "b", "in");
  bring_to_running("b");
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    expect_done(on_process(ActionKind::Deploy, "p"));
    expect_done(apply(task_of("a", "any::Thing"), "p"));
    expect_done(on_connection(ActionKind::Connect, connection));
    constexpr int kValues = 20;
    std::counting_semaphore<> carried_out{0};
    std::thread actor([&] {
      for (int value = 0; value < kValues; ++value) {
        const auto properties = type::Value::map({{"value", value}});
        static_cast<void>(perform(apply(task_of("a", "any::Thing", properties), "p")));
        carried_out.release();
        static_cast<void>(perform(on_connection(ActionKind::Connect, wire("b", "out", "a", "in"))));
        carried_out.release();
      }
    });
    for (int action = round % (2 * kValues); action > 0; --action)
      carried_out.acquire();
    expect_done(kill);
    actor.join();
    const auto left = host_.observe();
    ASSERT_EQ(left.find_task(model::TaskId("a")), nullptr);
    ASSERT_THAT(left.connections, ::testing::IsEmpty());
  }
}

TEST_F(LocalHost, ObservesPropertiesThatWereChangedFromOutside) {
  expect_done(apply(
      task_of("a", "any::Thing", type::Value::map({{"range", type::Value::map({{"min", 1}, {"max", 2}})}}))));
  ASSERT_TRUE(host_.set_property(model::TaskId("a"), "range.max", 30, soon()));
  const auto seen = host_.observe();
  EXPECT_EQ(seen.tasks.front().properties,
            type::Value::map({{"range", type::Value::map({{"min", 1}, {"max", 30}})}}));
  EXPECT_FALSE(host_.set_property(model::TaskId("a"), "rnge.max", 30, soon()));
  EXPECT_FALSE(host_.set_property(model::TaskId("a"), "", 30, soon()));
  EXPECT_FALSE(host_.set_property(model::TaskId("a"), "...", 30, soon()));
  expect_done(apply(task_of("a", "any::Thing")));
  EXPECT_EQ(host_.observe().tasks.front().properties, type::Value(type::ValueMap{}));
}

TEST_F(LocalHost, EntriesThatTheNetworkNoLongerHasAreGoneFromTheTask) {
  const auto range = [](const type::Value& value) { return type::Value::map({{"range", value}}); };
  const auto both = range(type::Value::map({{"min", 1}, {"max", 2}}));
  const auto one = range(type::Value::map({{"min", 5}}));
  expect_done(apply(task_of("a", "any::Thing", both)));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_done(apply(task_of("a", "any::Thing", one)));
  const auto properties = host_.properties(model::TaskId("a"));
  ASSERT_TRUE(properties);
  EXPECT_EQ(*properties->find("range"), *one.find("range"));
  EXPECT_EQ(host_.observe().tasks.front().properties, one);
  ASSERT_TRUE(host_.set_property(model::TaskId("a"), "range", type::Value::map({{"max", 7}}), soon()));
  EXPECT_EQ(*host_.properties(model::TaskId("a"))->find("range"), type::Value::map({{"max", 7}}));
  EXPECT_EQ(host_.observe().tasks.front().properties, range(type::Value::map({{"max", 7}})));
}

TEST_F(LocalHost, RefusesHostileProperties) {
  auto task = task_of("a", "any::Thing", type::Value::map({{"stand_in", 3}}));
  expect_refused(apply(task), ErrorCode::InvalidArgument, "stand_in");
  task.properties = type::Value::List{};
  expect_refused(apply(task), ErrorCode::InvalidArgument, "expected a map");
  task.properties = 3;
  expect_refused(apply(task), ErrorCode::InvalidArgument, "expected a map");
}

TEST_F(LocalHost, KeepsConnectionsWhenATaskGetsAnotherActivityOrOtherProperties) {
  bring_to_running("a");
  bring_to_running("b");
  expect_done(on_connection(ActionKind::Connect, wire("a", "out", "b", "in")));
  while (host_.connections().front().written == 0) {
    std::this_thread::yield();
  }
  expect_done(on_task(ActionKind::Stop, "a"));
  expect_done(on_task(ActionKind::Cleanup, "a"));
  const std::uint64_t written = host_.connections().front().written;
  auto task = task_of("a", "any::Thing", type::Value::map({{"speed", 3}}));
  task.activity = Activity{Trigger::Periodic, std::chrono::milliseconds(7), {}, 0, {}, {}, false};
  expect_done(apply(task));
  ASSERT_EQ(host_.connections().size(), 1U);
  EXPECT_EQ(host_.connections().front().written, written) << "it is still the same one";
  EXPECT_EQ(host_.tasks().front().activity.period, std::chrono::milliseconds(7));
  EXPECT_EQ(*host_.properties(model::TaskId("a"))->find("speed"), 3);
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_refused(apply(task_of("a", "any::Thing")), ErrorCode::InvalidState, "activity");
}

TEST_F(LocalHost, GivesADeviceToOneConfiguredTaskOnly) {
  auto a = task_of("a", "any::Thing");
  auto b = task_of("b", "any::Thing");
  a.exclusive = b.exclusive = {"/dev/laser"};
  expect_done(apply(a));
  expect_done(apply(b));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_refused(on_task(ActionKind::Configure, "b"), ErrorCode::InvalidState, "held by task 'a'");
  expect_done(on_task(ActionKind::Cleanup, "a"));
  expect_done(on_task(ActionKind::Configure, "b"));
}

TEST_F(LocalHost, FailsWhereAStandInIsToldTo) {
  const auto failing = [](const char* what) {
    return task_of("a", "any::Thing", type::Value::map({{"stand_in", type::Value::map({{"fail", what}})}}));
  };
  expect_done(apply(failing("configure")));
  expect_refused(on_task(ActionKind::Configure, "a"), ErrorCode::HookFailed, "configure");
  expect_done(apply(failing("start")));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_refused(on_task(ActionKind::Start, "a"), ErrorCode::HookFailed, "start");
  expect_done(on_task(ActionKind::Cleanup, "a"));
  expect_done(apply(failing("connect")));
  expect_refused(on_connection(ActionKind::Connect, wire("a", "out", "a", "in")), ErrorCode::HookFailed,
                 "connect");
  expect_done(apply(failing("stop")));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_done(on_task(ActionKind::Start, "a"));
  EXPECT_FALSE(perform(on_task(ActionKind::Stop, "a")));
  EXPECT_EQ(state_of("a"), TaskState::Exception);
}

using Samples = Result<std::vector<type::Value>>;

/// Asks for the next samples of a port, and waits for them.
class Asked {
 public:
  Asked(PortReader& reader, const Wait& wait) {
    reader.next(10, wait, [answer = answer_](Samples samples) { answer->set_value(std::move(samples)); });
  }
  Samples answer() { return future_.get(); }
  [[nodiscard]] bool is_answered() const {
    return future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

 private:
  const std::shared_ptr<std::promise<Samples>> answer_ = std::make_shared<std::promise<Samples>>();
  std::future<Samples> future_ = answer_->get_future();
};

class WaitsForSamples : public LocalHost {
 protected:
  /// Of a task that is configured, and writes once it runs.
  std::unique_ptr<PortReader> reader() {
    expect_done(on_process(ActionKind::Deploy, "p"));
    expect_done(apply(
        task_of("a", "any::Thing", type::Value::map({{"stand_in", type::Value::map({{"rate", 1000}})}})),
        "p"));
    expect_done(on_task(ActionKind::Configure, "a"));
    return host_.open_reader({model::TaskId("a"), "state"}, 10).value();
  }
};

TEST_F(WaitsForSamples, UntilOneComes) {
  const auto reader = this->reader();
  Asked asked(*reader, Wait(TimePoint::max()));
  EXPECT_FALSE(asked.is_answered());
  expect_done(on_task(ActionKind::Start, "a"));
  const auto samples = asked.answer();
  ASSERT_TRUE(samples);
  EXPECT_FALSE(samples->empty());
}

TEST_F(WaitsForSamples, UntilItsWaitIsOver) {
  const auto reader = this->reader();
  const auto samples = Asked(*reader, Wait(RealClock::instance().now())).answer();
  ASSERT_TRUE(samples);
  EXPECT_TRUE(samples->empty());
}

TEST_F(WaitsForSamples, UntilNobodyWantsThemAnyMore) {
  const auto reader = this->reader();
  std::stop_source stop;
  Asked asked(*reader, Wait(TimePoint::max(), stop.get_token()));
  stop.request_stop();
  EXPECT_EQ(asked.answer().error().code, ErrorCode::Cancelled);
}

TEST_F(WaitsForSamples, UntilItsReaderEnds) {
  auto reader = this->reader();
  Asked asked(*reader, Wait(TimePoint::max()));
  reader.reset();
  EXPECT_EQ(asked.answer().error().code, ErrorCode::Cancelled);
}

TEST_F(WaitsForSamples, UntilItsTaskIsGone) {
  const auto reader = this->reader();
  expect_done(on_task(ActionKind::Cleanup, "a"));
  reader->read(10);  // that it was cleaned up
  Asked asked(*reader, Wait(TimePoint::max()));
  expect_done(on_process(ActionKind::Undeploy, "p"));
  EXPECT_EQ(asked.answer().error().code, ErrorCode::NotFound);
}

TEST_F(LocalHost, ReadsTheSamplesOfAPort) {
  expect_done(apply(
      task_of("a", "any::Thing", type::Value::map({{"stand_in", type::Value::map({{"rate", 1000}})}}))));
  expect_done(on_task(ActionKind::Configure, "a"));
  EXPECT_FALSE(host_.open_reader({model::TaskId("a"), "nothing"}, 10));
  EXPECT_FALSE(host_.open_reader({model::TaskId("b"), "state"}, 10));
  EXPECT_FALSE(host_.open_reader({model::TaskId("a"), "nothing"}, kMeasureWrites));
  EXPECT_EQ(host_.open_reader({model::TaskId("a"), "state"}, kMeasureWrites).value()->read(1).size(), 1U);
  EXPECT_FALSE(host_.open_reader({model::TaskId("a"), "state"}, std::size_t(-1)));
  auto reader = host_.open_reader({model::TaskId("a"), "state"}, 10);
  ASSERT_TRUE(reader) << to_string(reader.error());
  EXPECT_EQ((*reader)->type_name(), "/int32_t");
  expect_done(on_task(ActionKind::Start, "a"));
  expect_done(on_task(ActionKind::Stop, "a"));
  const auto samples = (*reader)->read(10);
  EXPECT_EQ(samples, (std::vector<type::Value>{2, 1}));
  EXPECT_TRUE((*reader)->read(10).empty());
  EXPECT_TRUE(host_.connections().empty()) << "a reader is not a connection of the network";
}

TEST_F(LocalHost, TellsOfATaskThatFailsByItselfButNotOfActions) {
  Mutex mutex;
  ConditionVariable told;
  std::vector<TaskEvent> events;
  host_.set_listener([&](const HostEvent& happened) {
    const auto& event = std::get<TaskEvent>(happened);
    const Lock lock(mutex);
    events.push_back(event);
    told.notify_all();
  });
  bring_to_running("quiet");
  const type::Value behaviour = type::Value::map({{"fail", "update"}, {"rate", 1000}});
  expect_done(apply(task_of("a", "any::Thing", type::Value::map({{"stand_in", behaviour}}))));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_done(on_task(ActionKind::Start, "a"));
  Lock lock(mutex);
  ASSERT_TRUE(told.wait_for(mutex, std::chrono::seconds(30), [&] { return !events.empty(); }));
  EXPECT_EQ(events.front().task, model::TaskId("a"));
  EXPECT_EQ(events.front().state, TaskState::Exception);
  EXPECT_THAT(events.front().message, HasSubstr("update"));
  lock.unlock();
  host_.set_listener({});
  EXPECT_EQ(events.size(), 1U);
  expect_done(on_task(ActionKind::Recover, "a"));
}

/// A question for a task of a host, and its answer.
class Watched {
 public:
  Watched(LocalTaskHost& host, LevelQuestion question, TimePoint deadline = soon()) {
    question_.ask(deadline, [&](const Wait& wait, LevelAnswer answered) {
      host.watch(question, wait, std::move(answered));
    });
  }
  [[nodiscard]] std::optional<Result<TaskLevel>> answer_so_far() { return question_.take(); }
  Result<TaskLevel> answer() {
    const TimePoint give_up = soon();
    while (true) {
      if (auto answer = question_.take()) return std::move(*answer);
      if (RealClock::instance().now() >= give_up) return fail(ErrorCode::DeadlineExceeded, "no answer");
      bell_->wait(give_up);
    }
  }

 private:
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  Question<TaskLevel> question_{bell_};
};

TEST_F(LocalHost, TellsAtOnceWhoHasNotSeenATaskHowItIs) {
  bring_to_running("a");
  Watched watched(host_, {model::TaskId("a")});
  EXPECT_EQ(watched.answer_so_far().value()->state, TaskState::Running);
}

TEST_F(LocalHost, TellsWhoHasSeenATaskOnceItIsInAnotherState) {
  bring_to_running("a");
  const auto seen = Watched(host_, {model::TaskId("a")}).answer();
  Watched watched(host_, {model::TaskId("a"), *seen});
  EXPECT_FALSE(watched.answer_so_far());
  expect_done(on_task(ActionKind::Stop, "a"));
  EXPECT_EQ(watched.answer()->state, TaskState::Stopped);
}

TEST_F(LocalHost, TellsTheNewestStateOfATaskThatHasChangedOften) {
  bring_to_running("a");
  const auto seen = Watched(host_, {model::TaskId("a")}).answer();
  expect_done(on_task(ActionKind::Stop, "a"));
  expect_done(on_task(ActionKind::Cleanup, "a"));
  EXPECT_EQ(Watched(host_, {model::TaskId("a"), *seen}).answer()->state, TaskState::PreOperational);
}

TEST_F(LocalHost, TellsWhoWantsEachUpdateOfTheNextOne) {
  model::Task periodic = task_of("a", "any::Thing");
  periodic.activity = Activity{Trigger::Periodic, std::chrono::milliseconds(1), {}, 0, {}, {}, false};
  expect_done(apply(periodic));
  expect_done(on_task(ActionKind::Configure, "a"));
  expect_done(on_task(ActionKind::Start, "a"));
  const auto seen = Watched(host_, {model::TaskId("a")}).answer();
  EXPECT_GT(Watched(host_, {model::TaskId("a"), *seen, true}).answer()->updates, seen->updates);
}

TEST_F(LocalHost, TellsHowATaskIsAtTheDeadlineWhereItDoesNotChange) {
  bring_to_running("a");
  const auto seen = Watched(host_, {model::TaskId("a")}).answer();
  Watched watched(host_, {model::TaskId("a"), *seen},
                  RealClock::instance().now() + std::chrono::milliseconds(5));
  EXPECT_EQ(watched.answer()->state, TaskState::Running);
}

TEST_F(LocalHost, TellsWhoWatchesATaskThatItIsGone) {
  expect_done(on_process(ActionKind::Deploy, "p"));
  expect_done(apply(task_of("a", "any::Thing"), "p"));
  const auto seen = Watched(host_, {model::TaskId("a")}).answer();
  Watched watched(host_, {model::TaskId("a"), *seen});
  expect_done(on_process(ActionKind::Undeploy, "p"));
  EXPECT_EQ(watched.answer().error().code, ErrorCode::NotFound);
}

TEST(LocalHostThatEnds, TellsWhoWatchesItsTasks) {
  const model::ComponentCatalog catalog;
  const LibrarySet libraries;
  auto host =
      std::make_unique<LocalTaskHost>(libraries, catalog, LocalOptions{.stand_in = true, .stand_ins = {}});
  ASSERT_TRUE(host->perform(apply(task_of("a", "any::Thing")), soon()));
  const auto seen = Watched(*host, {model::TaskId("a")}).answer();
  Watched watched(*host, {model::TaskId("a"), *seen});
  host.reset();
  EXPECT_EQ(watched.answer().error().code, ErrorCode::Unavailable);
}

TEST(LocalHostWithoutStandIns, NamesTheMissingComponent) {
  const model::ComponentCatalog catalog;
  const LibrarySet libraries;
  LocalTaskHost host(libraries, catalog);
  const auto done = host.perform(apply(task_of("a", "missing::Thing")), soon());
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::NotFound);
  EXPECT_THAT(done.error().message, HasSubstr("missing::Thing"));
  EXPECT_FALSE(host.stands_in(model::ComponentName("missing::Thing")));
}

}  // namespace
}  // namespace segue::task_host
