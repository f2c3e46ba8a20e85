// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/fake_port.hpp>
#include <segue/mission_robot/watched_ports.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace segue::mission {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using type::Value;

/// Hands a port's questions on, and keeps them.
class NotedSamples final : public PortSamples {
 public:
  struct Notes {
    std::vector<Wait> waits;
    std::vector<SamplesAnswer> answers;
  };
  NotedSamples(std::unique_ptr<PortSamples> samples, Notes& notes)
      : samples_(std::move(samples)), notes_(notes) {}
  Result<std::vector<Value>> take(const Wait& wait) override { return samples_->take(wait); }
  void next(const Wait& wait, SamplesAnswer answered) override {
    notes_.waits.push_back(wait);
    notes_.answers.push_back(answered);
    samples_->next(wait, std::move(answered));
  }

 private:
  const std::unique_ptr<PortSamples> samples_;
  Notes& notes_;
};

class PortsThatAreWatched : public ::testing::Test {
 protected:
  PortsThatAreWatched() {
    ports_.follow(place_, std::make_unique<NotedSamples>(port_.open(), notes_));
    ports_.ask();
  }

  const Member place_{"base", "place"};
  FakePort port_;
  NotedSamples::Notes notes_;
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  WatchedPorts ports_{bell_};
};

TEST_F(PortsThatAreWatched, AreAskedOnceWhileNoSampleComes) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(ports_.poll());
    ports_.ask();
  }
  EXPECT_EQ(notes_.waits.size(), 1U);
  EXPECT_EQ(ports_.next_question(), TimePoint::max());
}

TEST_F(PortsThatAreWatched, RingWhenASampleComes) {
  port_.show(Value(1));
  bell_->wait(Wait(TimePoint::max()));  // returns
  EXPECT_TRUE(ports_.poll());
  EXPECT_THAT(ports_.fresh(place_), ElementsAre(Value(1)));
}

TEST_F(PortsThatAreWatched, ShowEachSampleOnce) {
  port_.show(Value(1));
  EXPECT_TRUE(ports_.poll());
  EXPECT_TRUE(ports_.poll());
  EXPECT_THAT(ports_.fresh(place_), IsEmpty());
}

TEST_F(PortsThatAreWatched, AreAskedAnewAfterAWhileAndMissNothing) {
  port_.show(Value(1));
  EXPECT_TRUE(ports_.poll());
  port_.show(Value(2));
  port_.show(Value(3));
  const TimePoint next = ports_.next_question();
  ASSERT_NE(next, TimePoint::max());
  while (notes_.waits.size() < 2) {
    bell_->wait(Wait(ports_.next_question()));
    ports_.ask();
  }
  EXPECT_GE(RealClock::instance().now(), next);
  EXPECT_TRUE(ports_.poll());
  EXPECT_THAT(ports_.fresh(place_), ElementsAre(Value(2), Value(3)));
}

TEST_F(PortsThatAreWatched, SayWhyTheyCannotBeRead) {
  notes_.answers.back()(fail(ErrorCode::NotFound, "its task is gone"));
  EXPECT_EQ(ports_.poll().error().message, "its task is gone");
}

TEST(APortThatIsWatched, IsAskedForNothingAnyMoreOnceNobodyFollowsIt) {
  FakePort port;
  NotedSamples::Notes notes;
  {
    WatchedPorts ports(std::make_shared<Bell>());
    ports.follow({"base", "place"}, std::make_unique<NotedSamples>(port.open(), notes));
    ports.ask();
  }
  EXPECT_TRUE(notes.waits.back().is_stopped());
}

}  // namespace
}  // namespace segue::mission
