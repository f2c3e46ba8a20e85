// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/watched_tasks.hpp>

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace segue::mission {
namespace {

/// Keeps the questions for its tasks until the test answers them.
class AskedRobot final : public CommandedRobot {
 public:
  struct Asked {
    TaskQuestion question;
    Wait wait;
    TaskAnswer answer;
  };
  std::vector<Asked> asked;

  void watch(const TaskQuestion& question, const Wait& wait, TaskAnswer answered) override {
    asked.push_back({question, wait, std::move(answered)});
  }
  void changes(std::uint64_t /*seen*/, const Wait& /*wait*/, ChangesAnswer answered) override {
    answered(no());
  }
  Result<void> request(const ControllerRequest& /*what*/, const Wait& /*wait*/) override { return no(); }
  Result<ControllerTrouble> trouble(std::string_view /*controller*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<ControllerConflicts> conflicts(const Wait& /*wait*/) override { return no(); }
  Result<void> prepare(const std::vector<std::string>& /*names*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<type::Value> call(const Member& /*operation*/, const type::Value& /*arguments*/,
                           const Wait& /*wait*/) override {
    return no();
  }
  Result<void> set(const Member& /*property*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<void> write(const Member& /*port*/, const type::Value& /*value*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& /*port*/, const Wait& /*wait*/) override {
    return no();
  }

 private:
  static Error no() { return fail(ErrorCode::Unsupported, "not in this test"); }
};

class TasksThatAreWatched : public ::testing::Test {
 protected:
  /// Answers the last question, and asks the next one.
  Result<void> answer(Result<TaskView> how) {
    robot_.asked.back().answer(std::move(how));
    auto polled = tasks_.poll();
    tasks_.ask();
    return polled;
  }
  const TaskQuestion& last() { return robot_.asked.back().question; }

  AskedRobot robot_;
  WatchedTasks tasks_{robot_, std::make_shared<Bell>()};
  const TaskView driving_{"running", "driving", 5};
  const TaskView arrived_{"running", "arrived", 9};
};

TEST_F(TasksThatAreWatched, SayFirstHowTheyAre) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_EQ(last().seen, std::nullopt);
  EXPECT_EQ(tasks_.view("planner"), nullptr);
  EXPECT_TRUE(answer(driving_));
  EXPECT_EQ(*tasks_.view("planner"), driving_);
}

TEST_F(TasksThatAreWatched, AreAskedOneQuestionAtATime) {
  tasks_.follow("planner", 0);
  for (int i = 0; i < 10; ++i)
    tasks_.ask();
  EXPECT_EQ(robot_.asked.size(), 1U);
}

TEST_F(TasksThatAreWatched, AreAskedForWhatIsNotAsItWasSeen) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  EXPECT_EQ(last().seen, driving_);
  EXPECT_TRUE(answer(arrived_));
  EXPECT_EQ(last().seen, arrived_);
}

TEST_F(TasksThatAreWatched, AreAskedForUpdatesUntilThereAreEnough) {
  tasks_.follow("planner", driving_.updates);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  EXPECT_TRUE(last().each_update);
  EXPECT_TRUE(answer(arrived_));
  EXPECT_FALSE(last().each_update);
}

TEST_F(TasksThatAreWatched, AreNotAskedAgainAtOnceWhereTheyHaveOnlyBeenUpdated) {
  tasks_.follow("planner", 100);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  TaskView updated = driving_;
  ++updated.updates;
  EXPECT_TRUE(answer(updated));
  EXPECT_EQ(robot_.asked.size(), 2U);
  EXPECT_LE(tasks_.next_question(), RealClock::instance().now() + WatchedTasks::kBetweenUpdates);
}

TEST_F(TasksThatAreWatched, AreAskedHowTheyAreOnceTheyCanBeSeenAgain) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  EXPECT_TRUE(answer(fail(ErrorCode::Unavailable, "its process is gone")));
  EXPECT_EQ(tasks_.view("planner"), nullptr);
  EXPECT_EQ(last().seen, std::nullopt);
  EXPECT_TRUE(answer(arrived_));
  EXPECT_EQ(*tasks_.view("planner"), arrived_);
}

TEST_F(TasksThatAreWatched, HaveBegunAnewOnceTheyRunAfterTheyWereGone) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  EXPECT_TRUE(answer(fail(ErrorCode::NotFound, "no task planner runs")));
  EXPECT_TRUE(answer(TaskView{"stopped", "", 0}));
  EXPECT_EQ(tasks_.view("planner"), nullptr) << "it is being started";
  EXPECT_FALSE(tasks_.has_begun_anew());
  const auto questions = robot_.asked.size();
  ASSERT_TRUE(segue::testing::eventually([&] {
    tasks_.ask();
    return robot_.asked.size() > questions;
  }));
  EXPECT_TRUE(answer(driving_));
  EXPECT_EQ(tasks_.take_begun_anew(), std::vector<std::string>{"planner"});
  EXPECT_TRUE(tasks_.take_begun_anew().empty());
}

TEST_F(TasksThatAreWatched, HaveBegunAnewWhereTheirUpdatesAreCountedAnew) {
  tasks_.follow_if_seen("planner");
  tasks_.ask();
  EXPECT_TRUE(answer(arrived_));
  EXPECT_FALSE(tasks_.has_begun_anew());
  EXPECT_TRUE(answer(driving_));
  EXPECT_TRUE(tasks_.has_begun_anew());
}

TEST_F(TasksThatAreWatched, HaveNotBegunAnewWhereTheyOnlyDoNotAnswer) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_TRUE(answer(driving_));
  EXPECT_TRUE(answer(fail(ErrorCode::DeadlineExceeded, "its process does not answer")));
  EXPECT_TRUE(answer(arrived_));
  EXPECT_FALSE(tasks_.has_begun_anew());
}

TEST_F(TasksThatAreWatched, FailWhereTheyCannotBeSeenAtAll) {
  tasks_.follow("planner", 0);
  tasks_.ask();
  EXPECT_EQ(answer(fail(ErrorCode::NotFound, "no task planner runs")).error().code, ErrorCode::NotFound);
}

TEST_F(TasksThatAreWatched, AreNotWaitedForByThoseThatHaveGone) {
  {
    WatchedTasks watched(robot_, std::make_shared<Bell>());
    watched.follow("planner", 0);
    watched.ask();
  }
  EXPECT_TRUE(robot_.asked.back().wait.is_stopped());
  robot_.asked.back().answer(driving_);
}

}  // namespace
}  // namespace segue::mission
