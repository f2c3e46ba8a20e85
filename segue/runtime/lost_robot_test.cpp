// SPDX-License-Identifier: Apache-2.0
//
// A runtime whose robot another one has got on other computers.
#include <segue/base/mutex.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/eventually.hpp>
#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <string>

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A host that says that another runtime has got the robot, once the test wishes.
class LosableHost final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;

  void lose() {
    lost_ = true;
    const Lock lock(mutex_);
    listener_(task_host::LossEvent{"another runtime has got the robot"});
  }
  [[nodiscard]] std::optional<Error> loss() const override {
    return lost_ ? std::optional<Error>(fail(ErrorCode::Superseded, "runtime 'rival' has got this robot"))
                 : std::nullopt;
  }
  void set_listener(Listener listener) override {
    const Lock lock(mutex_);
    listener_ = std::move(listener);
  }
  [[nodiscard]] model::Network observe() const override {
    ++looks_;
    return ForwardingHost::observe();
  }
  [[nodiscard]] int looks() const { return looks_; }

 private:
  std::atomic<bool> lost_{false};
  mutable std::atomic<int> looks_{0};
  Mutex mutex_;  ///< protects the member below; held while it is called
  Listener listener_;
};

class LostRuntime : public ::testing::Test {
 protected:
  LostRuntime() {
    EXPECT_FALSE(runtime_.add_controller(testing::network_of("network: one\ntasks: {a: {component: x::A}}"))
                     .has_errors());
    EXPECT_FALSE(runtime_.add_controller(testing::network_of("network: two\ntasks: {b: {component: x::B}}"))
                     .has_errors());
    EXPECT_EQ(runtime_.switch_to(model::NetworkName("one")).outcome, Outcome::Done);
  }
  static RuntimeOptions options() {
    RuntimeOptions options;
    options.policies.on_failure = model::FailurePolicy::Restart;
    options.policies.restart.backoff = 1ms;
    options.policies.watch = 1ms;
    return options;
  }
  /// Whoever runs it has nothing to do with the runtime.
  void stop_task() {
    const model::Action stop{
        1, model::ActionKind::Stop, model::TaskAction{model::TaskId("a")}, model::Phase::Commit, {}};
    EXPECT_TRUE(local_.perform(stop, RealClock::instance().now() + 30s));
  }
  [[nodiscard]] bool runs() const {
    const auto seen = local_.observe();
    const auto* task = seen.find_task(model::TaskId("a"));
    return task != nullptr && task->state == TaskState::Running;
  }

  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost local_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  LosableHost host_{local_};
  Runtime runtime_{"robot", host_, catalog_, options()};
};

TEST_F(LostRuntime, RefusesWhateverIsRequested) {
  host_.lose();
  const auto refused = runtime_.switch_to(model::NetworkName("two"));
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  ASSERT_TRUE(refused.error);
  EXPECT_EQ(refused.error->code, ErrorCode::Superseded);
  EXPECT_THAT(to_string(*refused.error), HasSubstr("`segue run --take-over`"));
  EXPECT_THAT(to_string(*refused.error), HasSubstr("'rival'"));
  EXPECT_TRUE(runs()) << "what runs is left as it is";
}

TEST_F(LostRuntime, IsNotGivenTheRobotByARequestThatTakesItOver) {
  host_.lose();
  const auto refused = runtime_.switch_to(model::NetworkName("two"), {.who = "eve", .take_over = true});
  EXPECT_EQ(refused.outcome, Outcome::Refused);
}

TEST_F(LostRuntime, TakesTheRobotFromWhoeverCommandsItHere) {
  const auto lease = runtime_.served().take_lease("mission patrol");
  ASSERT_TRUE(lease);
  host_.lose();
  EXPECT_EQ(runtime_.served().lease_standing(*lease).lost_to, "another runtime");
  EXPECT_EQ(runtime_.served().report(*lease, "driving").error().code, ErrorCode::InvalidState);
}

TEST_F(LostRuntime, LetsNobodyCommandTheRobot) {
  host_.lose();
  EXPECT_EQ(runtime_.served().take_lease("mission patrol").error().code, ErrorCode::Superseded);
}

TEST_F(LostRuntime, LetsNobodyTouchTasks) {
  host_.lose();
  const auto allowed =
      runtime_.served().allow({.who = "ann", .lease = 0, .beside_mission = true}, "sets 'a.speed'");
  ASSERT_FALSE(allowed);
  EXPECT_EQ(allowed.error().code, ErrorCode::Superseded);
}

TEST_F(LostRuntime, PreparesNothing) {
  host_.lose();
  const auto ready = runtime_.prepare({model::NetworkName("two")}).get();
  ASSERT_THAT(ready, SizeIs(1));
  EXPECT_FALSE(ready.front().ready);
  EXPECT_THAT(ready.front().reason, HasSubstr("lost the robot"));
}

TEST_F(LostRuntime, RepairsNothing) {
  stop_task();
  ASSERT_TRUE(segue::testing::eventually([&] { return runs(); })) << "it is repaired before";
  host_.lose();
  stop_task();
  const int looks = host_.looks();
  ASSERT_TRUE(segue::testing::eventually([&] { return host_.looks() >= looks + 100; }));
  EXPECT_FALSE(runs());
}

TEST_F(LostRuntime, SaysSoInItsStatus) {
  EXPECT_TRUE(status_of(runtime_).find("lost")->is_null());
  host_.lose();
  EXPECT_THAT(status_of(runtime_).find("lost")->as_string(), HasSubstr("'rival'"));
}

TEST_F(LostRuntime, CanStillStopWhatRunsHere) {
  host_.lose();
  EXPECT_EQ(runtime_.take_down().get().outcome, Outcome::Done);
  EXPECT_FALSE(runs());
}

}  // namespace
}  // namespace segue::runtime
