// SPDX-License-Identifier: Apache-2.0
#include "wire/command.hpp"

#include <gtest/gtest.h>

namespace segue::wire {
namespace {

using namespace std::chrono_literals;

struct WireCommand : testing::Test {
  std::string say(std::string_view line) { return obey(queue, {"a", "b", "c"}, line); }
  const Impairment& at(std::size_t from, std::size_t to) { return queue.impairment(from, to); }

  FrameQueue queue{3, 1};
};

TEST_F(WireCommand, SetsAllDirectionsIfItNamesNone) {
  EXPECT_EQ(say("delay 20ms jitter 500us loss 5% duplicate 0.5% reorder 25% 2ms"), "ok");
  const Impairment expected{20ms, 500us, 0.05, 0.005, 0.25, 2ms, false};
  EXPECT_EQ(at(0, 1), expected);
  EXPECT_EQ(at(2, 1), expected);
}

TEST_F(WireCommand, SetsOneDirection) {
  EXPECT_EQ(say("cut a>b"), "ok");
  EXPECT_TRUE(at(0, 1).cut);
  EXPECT_FALSE(at(1, 0).cut);
  EXPECT_FALSE(at(0, 2).cut);
}

TEST_F(WireCommand, SetsBothDirectionsOfOneStation) {
  EXPECT_EQ(say("cut b<>*"), "ok");
  EXPECT_TRUE(at(0, 1).cut && at(1, 0).cut && at(1, 2).cut && at(2, 1).cut);
  EXPECT_FALSE(at(0, 2).cut || at(2, 0).cut);
}

TEST_F(WireCommand, HealsWhatIsCutAndNothingElse) {
  say("loss 5% cut");
  EXPECT_EQ(say("heal"), "ok");
  EXPECT_EQ(at(0, 1), Impairment{.loss = 0.05});
}

TEST_F(WireCommand, ClearsEveryImpairment) {
  say("loss 5% delay 1s cut");
  EXPECT_EQ(say("clear a<>b"), "ok");
  EXPECT_EQ(at(1, 0), Impairment{});
  EXPECT_TRUE(at(0, 2).cut);
}

TEST_F(WireCommand, CountsEachDirection) {
  queue.send(0, 1, {}, 0ns);
  const std::string answer = say("count");
  EXPECT_EQ(answer.substr(0, answer.find('\n')),
            "a>b: sent 1 delivered 0 lost 0 duplicated 0 held_back 0 overflowed 0");
  EXPECT_EQ(answer.substr(answer.rfind('\n')), "\nok");
}

TEST_F(WireCommand, RefusesWhatItDoesNotUnderstandAndChangesNothing) {
  EXPECT_EQ(say("loss 5% a>d"), "error: there is no station 'd'");
  EXPECT_EQ(say("loss 5%  slow"), "error: there is no setting 'slow'");
  EXPECT_EQ(say("loss 5%  delay"), "error: 'delay' has no value");
  EXPECT_EQ(say("delay 5"), "error: '5' is not a time such as 20ms");
  EXPECT_EQ(say("loss 101%"), "error: '101%' is not a share such as 5%");
  EXPECT_EQ(say("loss -1%"), "error: '-1%' is not a quantity");
  EXPECT_EQ(say("loss nan%"), "error: 'nan%' is not a quantity");
  EXPECT_EQ(say("loss 5% a>b delay 1ms"), "error: 'delay' follows the directions, which come last");
  EXPECT_EQ(say(""), "error: nothing is said");
  EXPECT_EQ(at(0, 1), Impairment{});
}

}  // namespace
}  // namespace segue::wire
