// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/local_host.hpp>

#include <segue/base/file.hpp>
#include <segue/process_server/process_hub.hpp>
#include <support/eventually.hpp>
#include <support/fake_hosts.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <future>
#include <map>
#include <thread>

namespace segue::distributed {
namespace {

using namespace std::chrono_literals;
using testing::Computer;
using testing::request_of;

TimePoint in_time() {
  return RealClock::instance().now() + 30s;
}

std::shared_ptr<HostedRobot> acquired(Computer& computer, const RobotRequest& request) {
  auto robot = computer.local->acquire(request, in_time());
  EXPECT_TRUE(robot) << to_string(robot.error());
  return robot ? std::move(*robot) : nullptr;
}

template <class T>
std::optional<ErrorCode> code_of(const Result<T>& result) {
  return result ? std::nullopt : std::optional(result.error().code);
}

/// The start of a process, which lasts until the test ends it.
class StartThatLasts {
 public:
  explicit StartThatLasts(Computer& computer) {
    computer.world.on_call([this, ended = end_.get_future().share()](const std::string& what, const auto&) {
      if (what == "start") {
        begin_.set_value();
        ended.wait();
      }
    });
  }
  void wait_for_begin() { begin_.get_future().wait(); }
  void end() { end_.set_value(); }

 private:
  std::promise<void> begin_;
  std::promise<void> end_;
};

/// The code with which each function of a robot refuses; nothing where it does what it shall.
std::map<std::string, std::optional<ErrorCode>> refusals(HostedRobot& robot) {
  const model::TaskId a("a");
  const task::SavedState state;
  model::Deployment deployment;
  deployment.host = model::HostName("left");
  deployment.process = model::ProcessName("q");
  const model::Action deploy{
      1, model::ActionKind::Deploy, model::DeploymentAction{deployment}, model::Phase::Prepare, {}};
  std::map<std::string, std::optional<ErrorCode>> all;
  all["renew"] = code_of(robot.renew());
  all["snapshot"] = code_of(robot.snapshot());
  all["expect"] = code_of(robot.expect({}));
  all["begin_transition"] = code_of(robot.begin_transition({}, {}));
  all["get_ready"] = code_of(robot.get_ready({}, {}, in_time()));
  all["arm_commit"] = code_of(robot.arm_commit({}, 1, in_time()));
  all["vote"] = code_of(robot.vote(1, 1s));
  all["commit"] = code_of(robot.commit(1));
  all["conclude"] = code_of(robot.conclude({}));
  all["withdraw"] = code_of(robot.withdraw());
  all["perform"] = code_of(robot.perform_all(std::span(&deploy, 1), in_time()).front());
  all["perform in order"] = code_of(task_host::wait_for_outcomes(1, [&](task_host::Completion completed) {
                                      robot.begin_in_order({deploy}, 10s, std::move(completed));
                                    }).front());
  all["save_state"] = code_of(robot.save_state(a, in_time()));
  all["restore_state"] = code_of(robot.restore_state(a, state, in_time()));
  all["describe"] = code_of(robot.describe(a));
  all["properties"] = code_of(robot.properties(a));
  all["details"] = code_of(robot.details(a));
  all["set_property"] = code_of(robot.set_property(a, "p", type::Value(1), in_time()));
  all["call"] = code_of(robot.call(a, "op", type::Value(1), in_time()));
  all["open_reader"] = code_of(robot.open_reader({a, "out"}, 1));
  all["end_processes"] = code_of(robot.end_processes(in_time()));
  all["release"] = code_of(robot.release());
  return all;
}

TEST(LocalHost, WhoseRobotWasTakenOverCanDoNothingAnyMore) {
  Computer computer("left");
  const auto former = acquired(computer, request_of("a"));
  EXPECT_EQ(code_of(computer.local->acquire(request_of("b"), in_time())), ErrorCode::AlreadyExists);
  const auto present = acquired(computer, request_of("b", true));
  const int calls = computer.world.calls("start");
  for (const auto& [what, refusal] : refusals(*former)) {
    EXPECT_EQ(refusal, ErrorCode::Superseded) << what;
  }
  EXPECT_EQ(computer.world.calls("start"), calls);
  EXPECT_TRUE(computer.world.running().empty());
  const auto done = refusals(*present);
  EXPECT_EQ(done.at("perform"), std::nullopt);
  EXPECT_EQ(done.at("describe"), ErrorCode::NotFound);
  EXPECT_EQ(done.at("release"), std::nullopt);
  EXPECT_EQ(code_of(present->snapshot()), ErrorCode::Unavailable) << "it has been released";
}

TEST(LocalHost, WhoAsksAgainIsToldThatAnotherRuntimeHasHadTheRobotSince) {
  Computer computer("left");
  (void)acquired(computer, request_of("a"));
  auto again = request_of("a");
  again.again = true;
  (void)acquired(computer, again);
  ASSERT_TRUE(acquired(computer, request_of("b", true))->release());
  EXPECT_EQ(code_of(computer.local->acquire(again, in_time())), ErrorCode::Superseded);
}

TEST(LocalHost, CommitsOnlyWhatItHasPromised) {
  Computer computer("left");
  const auto robot = acquired(computer, request_of("a"));
  EXPECT_EQ(code_of(robot->vote(0, 1s)), ErrorCode::InvalidState);
  EXPECT_EQ(code_of(robot->vote(1, 1s)), ErrorCode::InvalidState) << "nothing is armed";
  ASSERT_TRUE(robot->arm_commit({}, 1, in_time()));
  EXPECT_EQ(code_of(robot->commit(1)), ErrorCode::InvalidState) << "nothing is promised";
  EXPECT_EQ(code_of(robot->vote(2, 1s)), ErrorCode::InvalidState);
  ASSERT_TRUE(robot->vote(1, 10s));
  EXPECT_EQ(code_of(robot->commit(2)), ErrorCode::InvalidState);
  EXPECT_TRUE(robot->commit(1));
  EXPECT_EQ(code_of(robot->commit(1)), ErrorCode::InvalidState) << "once";
  ASSERT_TRUE(robot->arm_commit({}, 2, in_time()));
  ASSERT_TRUE(robot->vote(2, 1ms));
  computer.clock.advance(5ms);
  EXPECT_EQ(code_of(robot->commit(2)), ErrorCode::InvalidState) << "too late";
  ASSERT_TRUE(robot->arm_commit({}, 3, in_time()));
  ASSERT_TRUE(robot->vote(3, 10s));
  ASSERT_TRUE(robot->withdraw());
  EXPECT_EQ(code_of(robot->commit(3)), ErrorCode::InvalidState) << "withdrawn";
}

TEST(LocalHost, ANewRuntimeGivesUpWhatTheFormerOneHadArmed) {
  Computer computer("left");
  const auto former = acquired(computer, request_of("a"));
  ASSERT_TRUE(former->arm_commit({}, 1, in_time()));
  ASSERT_TRUE(former->vote(1, 10s));
  const auto again = acquired(computer, request_of("a"));
  EXPECT_EQ(code_of(former->commit(1)), ErrorCode::Unavailable) << "it is the same runtime";
  EXPECT_EQ(code_of(again->commit(1)), ErrorCode::InvalidState);
}

TEST(LocalHost, RobotsThatWereGivenOutAreUnavailableOnceItIsGone) {
  Computer computer("left");
  const auto robot = acquired(computer, request_of("a"));
  computer.local.reset();
  for (const auto& [what, refusal] : refusals(*robot)) {
    EXPECT_EQ(refusal, ErrorCode::Unavailable) << what;
  }
  EXPECT_EQ(computer.world.calls("start"), 0);
}

TEST(LocalHost, WaitsForItsLastCallsWhenItEnds) {
  Computer computer("left");
  const auto robot = acquired(computer, request_of("a"));
  StartThatLasts start(computer);
  auto calls = std::async(std::launch::async, [&] { return refusals(*robot).at("perform"); });
  start.wait_for_begin();
  auto ends = std::async(std::launch::async, [&] { computer.local.reset(); });
  EXPECT_EQ(ends.wait_for(50ms), std::future_status::timeout);
  start.end();
  ends.get();
  (void)calls.get();
  EXPECT_EQ(code_of(robot->snapshot()), ErrorCode::Unavailable);
}

TEST(LocalHost, AdoptsWhatRunsAfterARestart) {
  Computer computer("left");
  const auto robot = acquired(computer, request_of("a"));
  const auto epoch = computer.local->robots().value().front().epoch;
  auto q = model::Deployment{};
  q.host = model::HostName("left");
  q.process = model::ProcessName("q");
  process_server::Launch launch;
  launch.robot = "robot";
  launch.deployment = q;
  computer.world.start(launch);
  computer.boot();
  const auto before = computer.local->robots().value();
  ASSERT_EQ(before.size(), 1U) << "it has processes here";
  EXPECT_EQ(before.front().robot, "robot");
  EXPECT_EQ(before.front().holder, "");
  EXPECT_EQ(code_of(computer.local->acquire(request_of("b"), in_time())), ErrorCode::AlreadyExists)
      << "whoever had the robot gets it first";
  const auto other = acquired(computer, request_of("b", true));
  const auto leases = computer.local->robots().value();
  ASSERT_EQ(leases.size(), 1U);
  EXPECT_EQ(leases.front().robot, "robot");
  EXPECT_EQ(leases.front().holder, "b");
  EXPECT_GT(leases.front().epoch, epoch);
  const auto seen = other->snapshot();
  ASSERT_TRUE(seen);
  ASSERT_EQ(seen->network.deployments.size(), 1U);
  EXPECT_EQ(to_string(seen->network.deployments.front().key()), "left/q");
}

TEST(LocalHost, ModelFilesAreKeptUnderNamesOfItsOwn) {
  Computer computer("left");
  auto request = request_of("a");
  request.models = {{"../../evil.yaml", "one"}, {"arm.yaml", "two"}, {"", "three"}};
  ASSERT_NE(acquired(computer, request), nullptr);
  const auto folder = computer.folder / "robots" / "robot.models";
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    texts.push_back(read_file(entry.path()).value());
  }
  std::sort(texts.begin(), texts.end());
  EXPECT_EQ(texts, (std::vector<std::string>{"one", "three", "two"}));
}

TEST(LocalHost, WhoseModelFilesCannotBeKeptLeavesTheRobotToOthers) {
  Computer computer("left");
  ASSERT_TRUE(write_file(computer.folder / "robots" / "robot.models", "where their folder should be"));
  auto request = request_of("a");
  request.models = {{"arm.yaml", "one"}};
  ASSERT_FALSE(computer.local->acquire(request, in_time()));
  EXPECT_NE(acquired(computer, request_of("b")), nullptr);
}

TEST(LocalHost, RefusesNamesThatArePaths) {
  Computer computer("left");
  for (const char* name : {"", "..", "../robot", "a/b", "/etc"}) {
    auto request = request_of("a");
    request.launch.robot = name;
    EXPECT_EQ(code_of(computer.local->acquire(request, in_time())), ErrorCode::InvalidArgument) << name;
  }
  EXPECT_TRUE(computer.local->robots().value().empty());
}

/// A host forgets robots that have gone, and has room for as many new ones.
TEST(LocalHost, ForgetsRobotsThatNobodyCommandsAnyMore) {
  Computer computer("left");
  const auto request_for = [](int number) {
    auto request = request_of("a");
    request.launch.robot = "robot" + std::to_string(number);
    return request;
  };
  std::vector<std::shared_ptr<HostedRobot>> robots;
  for (int i = 0; i < 64; ++i) {
    robots.push_back(acquired(computer, request_for(i)));
  }
  EXPECT_EQ(code_of(computer.local->acquire(request_for(64), in_time())), ErrorCode::ResourceExhausted);
  EXPECT_TRUE(robots.front()->release());
  EXPECT_EQ(code_of(computer.local->acquire(request_for(64), in_time())), ErrorCode::ResourceExhausted)
      << "its runtime may still send something";
  robots.erase(robots.begin());
  EXPECT_TRUE(acquired(computer, request_for(64)));
  EXPECT_EQ(code_of(computer.local->acquire(request_for(0), in_time())), ErrorCode::ResourceExhausted);
  robots.clear();
  computer.clock.advance(1min);
  EXPECT_TRUE(acquired(computer, request_for(0)));
}

TEST(LocalHost, GivesUpAtItsDeadlineWhereAnotherRuntimeIsGettingTheRobot) {
  Computer computer("left");
  const auto robot = acquired(computer, request_of("a"));
  StartThatLasts start(computer);
  auto calls = std::async(std::launch::async, [&] { return refusals(*robot).at("perform"); });
  start.wait_for_begin();
  auto first = std::async(std::launch::async,
                          [&] { return code_of(computer.local->acquire(request_of("b", true), in_time())); });
  ASSERT_TRUE(segue::testing::eventually([&] { return !robot->renew(); }));
  const TimePoint now = RealClock::instance().now();
  EXPECT_EQ(code_of(computer.local->acquire(request_of("c", true), now)), ErrorCode::DeadlineExceeded);
  start.end();
  EXPECT_EQ(first.get(), std::nullopt);
  (void)calls.get();
}

TEST(LocalHost, RuntimesThatComeAndGoHarmNobody) {
  Computer computer("left");
  std::atomic<int> done{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&, holder = "h" + std::to_string(i)] {
      for (int round = 0; round < 10; ++round) {
        const auto robot = computer.local->acquire(request_of(holder, true), in_time());
        if (!robot) {
          EXPECT_EQ(code_of(robot), ErrorCode::Superseded);
          continue;
        }
        (*robot)->set_listener([&](const task_host::HostEvent&) { ++done; });
        done += (*robot)->snapshot() ? 1 : 0;
        done += (*robot)->withdraw() ? 1 : 0;
        (*robot)->set_listener({});
      }
    });
  }
  for (auto& thread : threads) {
    thread.join();
  }
  EXPECT_GT(done, 0);
}

}  // namespace
}  // namespace segue::distributed
