// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission_robot/controller_union.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <future>
#include <map>
#include <set>
#include <thread>
#include <utility>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

/// Runs what it is asked to, unless a controller is broken.
class RequestedRobot final : public CommandedRobot {
 public:
  Result<void> request(const ControllerRequest& what, const Wait& wait) override {
    Lock lock(mutex_);
    requests_.push_back(what);
    asked_.notify_all();
    const std::size_t mine = requests_.size();
    asked_.wait_for(mutex_, wait.stop, 60s, [&] { return !held_ || mine <= let_go_; });
    if (wait.is_stopped() && !is_late_) return no_longer_wanted();
    for (const std::string& controller : what.controllers) {
      if (broken_.contains(controller)) return fail(ErrorCode::InvalidState, controller + " is broken");
    }
    runs_ = what;
    return {};
  }
  Result<ControllerTrouble> trouble(std::string_view controller, const Wait& /*wait*/) override {
    const Lock lock(mutex_);
    polls_.emplace_back(controller);
    return ControllerTrouble{.why = broken_.contains(std::string(controller)) ? "it is broken" : "",
                             .tasks = {},
                             .repair = repair_};
  }
  Result<ControllerConflicts> conflicts(const Wait& /*wait*/) override {
    Lock lock(mutex_);
    asked_.wait_for(mutex_, {}, 60s, [&] { return !keeps_conflicts_; });
    return ControllerConflicts{
        {}, {{"drive", "stick", "input base.command"}}, {{"explore", "drive", "input planner.goal"}}};
  }
  Result<void> prepare(const std::vector<std::string>& /*controllers*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<type::Value> call(const Member& /*operation*/, const type::Value& /*arguments*/,
                           const Wait& /*wait*/) override {
    return type::Value();
  }
  Result<void> set(const Member& /*property*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<void> write(const Member& /*port*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  void watch(const TaskQuestion& /*question*/, const Wait& /*wait*/, TaskAnswer answered) override {
    answered(TaskView{});
  }
  void changes(std::uint64_t seen, const Wait& /*wait*/, ChangesAnswer answered) override {
    if (seen == 0) answered(1);
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& /*port*/, const Wait& /*wait*/) override {
    return fail(ErrorCode::Unsupported, "not in this test");
  }

  /// Requests are not answered until let_go().
  void hold() {
    const Lock lock(mutex_);
    held_ = true;
  }
  /// Does not say what conflicts as long as this holds.
  void keep_conflicts(bool keeps) {
    const Lock lock(mutex_);
    keeps_conflicts_ = keeps;
    asked_.notify_all();
  }
  /// Whoever wants a request no longer is too late: the robot runs it.
  void be_late() {
    const Lock lock(mutex_);
    is_late_ = true;
  }
  void let_go() {
    const Lock lock(mutex_);
    held_ = false;
    asked_.notify_all();
  }
  /// The request under way is answered; others are not yet.
  void let_go_of_one() {
    const Lock lock(mutex_);
    let_go_ = requests_.size();
    asked_.notify_all();
  }
  void wait_for_requests(std::size_t count) {
    Lock lock(mutex_);
    EXPECT_TRUE(asked_.wait_for(mutex_, {}, 60s, [&] { return requests_.size() >= count; }));
  }
  void break_controller(const std::string& controller) {
    const Lock lock(mutex_);
    broken_.insert(controller);
  }
  void mend(const std::string& task) {
    const Lock lock(mutex_);
    repair_ = task;
  }
  /// The controllers that somebody has looked at.
  std::vector<std::string> polls() {
    const Lock lock(mutex_);
    return polls_;
  }
  ControllerRequest runs() {
    const Lock lock(mutex_);
    return runs_;
  }
  std::vector<ControllerRequest> requests() {
    const Lock lock(mutex_);
    return requests_;
  }

 private:
  Mutex mutex_;
  StoppableConditionVariable asked_;
  std::vector<ControllerRequest> requests_;
  ControllerRequest runs_;
  std::set<std::string> broken_;
  std::string repair_;
  std::vector<std::string> polls_;
  bool held_ = false;
  bool keeps_conflicts_ = false;
  std::size_t let_go_ = 0;  ///< that many requests are answered although it holds
  bool is_late_ = false;
};

class UnionOfControllers : public ::testing::Test {
 protected:
  std::future<Result<void>> begin(const std::string& controller, const ControllerWish& wish = {}) {
    return std::async(std::launch::async,
                      [this, controller, wish] { return union_.begin(controller, {}, wish); });
  }
  void wait_until_waiting(std::size_t count) {
    while (union_.waiting() < count)
      std::this_thread::yield();
  }

  std::shared_ptr<RequestedRobot> robot_ = std::make_shared<RequestedRobot>();
  ControllerUnion union_{robot_, {.gather = 0ms}};
};

TEST_F(UnionOfControllers, HoldsWhatIsInUseAndWhatIsKept) {
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm", "drive"));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_THAT(robot_->requests(), SizeIs(2)) << "what is kept runs on";
  EXPECT_TRUE(union_.begin("camera", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("camera", "arm", "drive"));
}

TEST_F(UnionOfControllers, SaysWhichActionsAskForIt) {
  EXPECT_TRUE(union_.begin("drive", {}, {.user = ControllerUser{"there", 2}}));
  EXPECT_TRUE(union_.end("drive", false, ControllerUser{"there", 2}));
  EXPECT_TRUE(union_.begin("arm", {}));
  const auto requests = robot_->requests();
  ASSERT_THAT(requests, SizeIs(3));
  EXPECT_THAT(requests[0].causes, ElementsAre(ControllerRequest::Cause{"there", 2, "drive"}));
  EXPECT_THAT(requests[1].causes, ElementsAre(ControllerRequest::Cause{"there", 2, ""}));
  EXPECT_THAT(requests[2].causes, IsEmpty()) << "it is not known";
}

TEST_F(UnionOfControllers, GivesUpWhatIsKeptForWhatConflictsWithIt) {
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_TRUE(union_.begin("stick", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("stick", "arm"));
}

TEST_F(UnionOfControllers, GivesUpWhatIsKeptWhereItWouldInterfere) {
  EXPECT_TRUE(union_.begin("explore", {}));
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("drive", "explore")) << "both are in use";
  EXPECT_TRUE(union_.end("explore", true));
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm", "drive"));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_TRUE(union_.begin("explore", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("explore", "arm", "drive"))
      << "drive writes to nothing of it";
}

/// Whichever of them runs already.
TEST_F(UnionOfControllers, GivesUpWhatIsKeptWhereItWouldInterfereWithWhatRunsAlready) {
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_TRUE(union_.begin("explore", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("explore", "drive"));
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_THAT(robot_->requests(), SizeIs(2)) << "both are in use";
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_TRUE(union_.end("explore", true));
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("drive"));
}

TEST_F(UnionOfControllers, StopsWhatIsNotKept) {
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_TRUE(union_.end("drive", false));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm"));
  EXPECT_TRUE(union_.end("arm", false));
  EXPECT_THAT(robot_->runs().controllers, IsEmpty());
}

TEST_F(UnionOfControllers, WaitsForNoOthersWhereTheControllerRunsAlready) {
  ControllerUnion one(robot_, {.gather = 1h});
  one.take_over("drive", {});
  EXPECT_TRUE(one.begin("drive", {})) << "returns at once";
  EXPECT_THAT(robot_->requests(), SizeIs(1)) << "its lease is to be had";
}

TEST_F(UnionOfControllers, DoesNotRequestWhatRunsWell) {
  const auto speed = [](int value) { return std::vector<MemberValue>{{{"base", "speed"}, value, {}}}; };
  EXPECT_TRUE(union_.begin("drive", speed(1)));
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_THAT(robot_->polls(), IsEmpty());
  EXPECT_TRUE(union_.begin("drive", speed(1)));
  EXPECT_THAT(robot_->polls(), ElementsAre("drive"));
  EXPECT_THAT(robot_->requests(), SizeIs(2));
  EXPECT_TRUE(union_.begin("drive", speed(2))) << "it runs with other properties";
  EXPECT_THAT(robot_->requests(), SizeIs(3));
  EXPECT_TRUE(union_.end("drive", false));
  EXPECT_TRUE(union_.end("drive", false));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm")) << "it was used twice";
}

TEST_F(UnionOfControllers, RequestsWhatDoesNotRunWell) {
  EXPECT_TRUE(union_.begin("drive", {}));
  robot_->mend("task base");
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_THAT(robot_->requests(), SizeIs(2));
  robot_->mend("");
  robot_->break_controller("drive");
  EXPECT_FALSE(union_.begin("drive", {}));
  EXPECT_THAT(robot_->requests(), SizeIs(3));
}

TEST_F(UnionOfControllers, DoesNotLookAtWhatWasSeenJustNow) {
  ControllerUnion one(robot_, {.gather = 0ms, .fresh = 1h});
  const auto now = [] { return RealClock::instance().now(); };
  const TimePoint before = now();
  EXPECT_TRUE(one.begin("drive", {}));
  one.note_runs("drive", before, now());
  EXPECT_TRUE(one.begin("drive", {}));
  EXPECT_THAT(robot_->polls(), SizeIs(1)) << "it was seen before the robot was to run this";
  EXPECT_TRUE(one.begin("drive", {}));
  one.note_runs("drive", now(), now());
  EXPECT_TRUE(one.begin("drive", {}));
  EXPECT_THAT(robot_->polls(), SizeIs(1));
  EXPECT_TRUE(one.begin("arm", {}));
  EXPECT_TRUE(one.begin("drive", {}));
  EXPECT_THAT(robot_->polls(), SizeIs(2)) << "another request has come since";
  one.note_changed();
  EXPECT_TRUE(one.begin("drive", {}));
  EXPECT_THAT(robot_->polls(), SizeIs(3));
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_FALSE(one.begin("drive", {}, {.stop = stopped.get_token()}));
  EXPECT_THAT(robot_->requests(), SizeIs(2));
}

TEST_F(UnionOfControllers, StopsNothingThatAnotherActionUses) {
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.begin("drive", {}));
  EXPECT_TRUE(union_.end("drive", false));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("drive"));
  EXPECT_TRUE(union_.end("drive", false));
  EXPECT_THAT(robot_->runs().controllers, IsEmpty());
}

TEST_F(UnionOfControllers, KeepsThePropertiesOfWhatRuns) {
  EXPECT_TRUE(union_.begin("drive", {{{"base", "speed"}, 1, {}}}));
  EXPECT_TRUE(union_.begin("arm", {{{"arm", "speed"}, 2, {}}}));
  EXPECT_THAT(robot_->runs().properties, SizeIs(2));
  EXPECT_TRUE(union_.end("drive", true));
  EXPECT_TRUE(union_.begin("drive", {{{"base", "speed"}, 3, {}}}));
  const auto properties = robot_->runs().properties;
  ASSERT_THAT(properties, SizeIs(2));
  EXPECT_EQ(properties.front().value, type::Value(3));
}

TEST_F(UnionOfControllers, GathersWhatIsAskedWhileATransitionIsUnderWay) {
  robot_->hold();
  auto drive = begin("drive");
  robot_->wait_for_requests(1);
  auto arm = begin("arm");
  auto camera = begin("camera");
  wait_until_waiting(2);
  robot_->let_go();
  EXPECT_TRUE(drive.get());
  EXPECT_TRUE(arm.get());
  EXPECT_TRUE(camera.get());
  EXPECT_THAT(robot_->runs().controllers, UnorderedElementsAre("drive", "arm", "camera"));
  EXPECT_THAT(robot_->requests(), SizeIs(2));
}

TEST_F(UnionOfControllers, GivesUpATransitionThatNobodyWantsAnyMore) {
  robot_->hold();
  std::stop_source stop;
  auto drive = begin("drive", {.stop = stop.get_token()});
  robot_->wait_for_requests(1);
  stop.request_stop();
  EXPECT_EQ(drive.get().error().code, ErrorCode::Cancelled);
  robot_->let_go();
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm")) << "drive was not in use";
}

TEST_F(UnionOfControllers, DoesNotAskForWhatIsWantedNoLonger) {
  robot_->hold();
  std::stop_source stop;
  auto drive = begin("drive");
  robot_->wait_for_requests(1);
  auto arm = begin("arm", {.stop = stop.get_token()});
  stop.request_stop();
  EXPECT_EQ(arm.get().error().code, ErrorCode::Cancelled);
  robot_->let_go();
  EXPECT_TRUE(drive.get());
  EXPECT_TRUE(union_.begin("camera", {}));
  for (const auto& request : robot_->requests())
    EXPECT_THAT(request.controllers, Not(Contains("arm")));
}

TEST_F(UnionOfControllers, DoesNotAskForWhatIsWantedNoLongerThoughNobodyHasTakenItBackYet) {
  robot_->keep_conflicts(true);
  std::stop_source stop;
  auto arm = begin("arm", {.stop = stop.get_token()});
  wait_until_waiting(1);
  auto drive = begin("drive");
  wait_until_waiting(2);
  // Runs before whoever waits for the arm is told.
  const std::stop_callback before(stop.get_token(), [&] {
    robot_->keep_conflicts(false);
    EXPECT_TRUE(drive.get());
  });
  stop.request_stop();
  EXPECT_EQ(arm.get().error().code, ErrorCode::Cancelled);
  for (const auto& request : robot_->requests())
    EXPECT_THAT(request.controllers, Not(Contains("arm")));
}

TEST_F(UnionOfControllers, CarriesOutATransitionThatAnotherActionStillWants) {
  robot_->hold();
  std::stop_source stop;
  auto camera = begin("camera");
  robot_->wait_for_requests(1);
  auto arm = begin("arm", {.stop = stop.get_token()});
  auto drive = begin("drive");
  wait_until_waiting(2);
  robot_->let_go_of_one();
  robot_->wait_for_requests(2);
  stop.request_stop();
  EXPECT_EQ(arm.get().error().code, ErrorCode::Cancelled);
  robot_->let_go();
  EXPECT_TRUE(drive.get());
  EXPECT_TRUE(camera.get());
  EXPECT_THAT(robot_->runs().controllers, Contains("drive"));
  EXPECT_THAT(robot_->requests(), SizeIs(2)) << "it was not asked for anew";
}

TEST_F(UnionOfControllers, StopsWhatItWasTooLateToGiveUp) {
  robot_->be_late();
  robot_->hold();
  std::stop_source stop;
  auto drive = begin("drive", {.stop = stop.get_token(), .keep = false});
  robot_->wait_for_requests(1);
  stop.request_stop();
  EXPECT_EQ(drive.get().error().code, ErrorCode::Cancelled);
  robot_->wait_for_requests(2);
  robot_->let_go();
  EXPECT_TRUE(union_.begin("arm", {}));
  EXPECT_THAT(robot_->requests()[1].controllers, IsEmpty());
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("arm"));
}

TEST_F(UnionOfControllers, StartsOneThatCannotRunWithoutHarmToTheOthers) {
  robot_->break_controller("arm");
  robot_->hold();
  auto camera = begin("camera");
  robot_->wait_for_requests(1);
  auto arm = begin("arm");
  auto drive = begin("drive");
  wait_until_waiting(2);
  robot_->let_go();
  EXPECT_TRUE(camera.get());
  EXPECT_FALSE(arm.get());
  EXPECT_TRUE(drive.get());
  EXPECT_THAT(robot_->runs().controllers, ElementsAre("drive", "camera"));
}

TEST_F(UnionOfControllers, IsConsistentWhateverActionsDoAtOnce) {
  std::vector<std::jthread> actions;
  for (const char* controller : {"drive", "arm", "camera", "drive"}) {
    actions.emplace_back([this, controller = std::string(controller)] {
      for (int turn = 0; turn < 50; ++turn) {
        EXPECT_TRUE(union_.begin(controller, {}));
        const auto running = robot_->runs().controllers;
        EXPECT_EQ(std::ranges::count(running, controller), 1);
        EXPECT_TRUE(union_.end(controller, turn % 2 == 0 && turn < 48));
      }
    });
  }
  actions.clear();
  EXPECT_THAT(robot_->runs().controllers, IsEmpty());
}

}  // namespace
}  // namespace segue::mission
