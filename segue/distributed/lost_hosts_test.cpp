// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/test_support.hpp>

namespace segue::distributed {
namespace {

TEST(DistributedTaskHost, ARuntimeWhoseRobotWasTakenOverCanDoNothingOnOtherHosts) {
  Computers computers;
  Commander former(computers);
  ASSERT_EQ(said(former.switch_to(kFirst)), "done");
  DistributedOptions options;
  {
    const Commander refused(computers, options, 1h, "other");
    const auto commands = refused.host.commands_all();
    ASSERT_FALSE(commands);
    EXPECT_EQ(commands.error().code, ErrorCode::AlreadyExists);
    EXPECT_NE(to_string(commands.error()).find("'me'"), std::string::npos);
  }
  EXPECT_TRUE(former.host.properties(TaskId("a"))) << "it has lost nothing";
  options.request.take_over = true;
  Commander present(computers, options, 1h, "other");
  EXPECT_TRUE(present.host.commands_all());
  EXPECT_FALSE(former.host.properties(TaskId("a")));
  EXPECT_FALSE(former.host.call(TaskId("a"), "op", type::Value(1), later()));
  EXPECT_FALSE(former.switch_to(kSecond));
  EXPECT_EQ(former.host.observe().find_task(TaskId("a")), nullptr);
  former.host.end_processes(later());
  EXPECT_NE(computers.left.world.find("p1"), nullptr);
  EXPECT_NE(present.host.observe().find_task(TaskId("a")), nullptr);
  EXPECT_TRUE(present.host.properties(TaskId("a")));
}

class LostRobot : public ::testing::Test {
 protected:
  static std::string holder_at(testing::Computer& computer) {
    const auto robots = computer.local->robots().value();
    return robots.empty() ? "" : robots.front().holder;
  }
  /// Another runtime takes the robot there, and nowhere else.
  std::shared_ptr<HostedRobot> rival_at(testing::Computer& computer) {
    auto robot = computer.local->acquire(testing::request_of("rival", true), later());
    EXPECT_TRUE(robot) << to_string(robot.error());
    return robot.value_or(nullptr);
  }
  [[nodiscard]] bool is_lost() {
    return eventually([&] { return former_.host.loss().has_value(); });
  }

  Computers computers_;
  Commander former_{computers_, {}, 10ms};
};

TEST_F(LostRobot, IsLostOnAllHostsOnceOneHasGivenItToAnotherRuntime) {
  ASSERT_EQ(said(former_.switch_to(kFirst)), "done");
  const auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(former_.told("right is lost"));
  ASSERT_TRUE(former_.host.loss());
  EXPECT_NE(to_string(*former_.host.loss()).find("'rival'"), std::string::npos);
  EXPECT_EQ(former_.host.commands_all().error().code, ErrorCode::Superseded);
  EXPECT_EQ(former_.host.properties(TaskId("c")).error().code, ErrorCode::Superseded) << "on the right";
  EXPECT_EQ(holder_at(computers_.left), "rival");
  EXPECT_TRUE(eventually([&] { return holder_at(computers_.right).empty(); })) << "its lease is given up";
}

TEST_F(LostRobot, IsSaidToBeLostOnceAndBeforeAHostIsGivenUpForIt) {
  const auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("right is lost"));
  const Lock lock(former_.mutex);
  const auto& events = former_.events;
  EXPECT_EQ(std::count(events.begin(), events.end(), "the robot is lost"), 1);
  EXPECT_LT(std::find(events.begin(), events.end(), "the robot is lost"),
            std::find(events.begin(), events.end(), "right is lost"));
}

TEST_F(LostRobot, IsNotAskedForAgainAlthoughNobodyElseHasIt) {
  auto rival = rival_at(computers_.left);
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(former_.told("right is lost"));
  ASSERT_TRUE(rival->release());
  ASSERT_TRUE(eventually([&] { return holder_at(computers_.right).empty(); })) << "its lease is given up";
  const int asked = computers_.left.line.calls("acquire") + computers_.right.line.calls("acquire");
  for (testing::Computer* computer : {&computers_.left, &computers_.right}) {
    computer->boot();
    computer->clock.advance(Lease::kValidity);
  }
  const Commander next(computers_, {}, 10ms, "next");
  const int renewed = computers_.left.line.calls("renew");
  ASSERT_TRUE(eventually([&] { return computers_.left.line.calls("renew") >= renewed + 3; }));
  EXPECT_EQ(computers_.left.line.calls("acquire") + computers_.right.line.calls("acquire"), asked + 2)
      << "only the next runtime has asked, once at each host";
}

TEST_F(LostRobot, IsLostAlsoToARuntimeThatHasLeftWhileTheFormerOneWasAway) {
  computers_.left.line.cut();
  ASSERT_TRUE(former_.told("left is lost"));
  ASSERT_TRUE(rival_at(computers_.left)->release());
  EXPECT_FALSE(former_.host.loss()) << "nobody has told it";
  computers_.left.line.mend();
  EXPECT_TRUE(is_lost());
}

TEST_F(LostRobot, IsNotLostByADaemonThatStartsAgain) {
  computers_.left.line.cut();
  ASSERT_TRUE(former_.told("left is lost"));
  computers_.left.boot();
  computers_.left.clock.advance(1h);
  computers_.left.line.mend();
  ASSERT_TRUE(former_.told("left is back"));
  EXPECT_FALSE(former_.host.loss());
}

TEST(DistributedTaskHost, AHostThatAnotherRuntimeHadFirstIsNotALostRobot) {
  Computers computers;
  computers.right.line.cut();
  Commander run(computers, {}, 10ms);
  const auto other = computers.right.local->acquire(testing::request_of("other"), later());
  ASSERT_TRUE(other);
  computers.right.line.mend();
  ASSERT_TRUE(eventually([&] { return run.computer("right").state.find("'other'") != std::string::npos; }));
  EXPECT_FALSE(run.host.loss());
  ASSERT_TRUE((*other)->release());
  EXPECT_TRUE(run.told("right is back")) << "it may have it now";
}

TEST(DistributedTaskHost, AnotherRuntimeMayHaveTheRobotOnceThisOneEnds) {
  Computers computers;
  {
    Commander run(computers);
    ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  }
  const Commander next(computers, {}, 1h, "other");
  EXPECT_TRUE(next.host.commands_all());
  EXPECT_NE(next.host.observe().find_task(TaskId("a")), nullptr) << "processes run on";
}

TEST(DistributedTaskHost, ACallThatFailsLateDoesNotLoseTheNextConnection) {
  Computers computers;
  Commander run(computers, {}, 10ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  std::promise<void> entered;
  std::promise<void> release;
  std::atomic<bool> first{true};
  computers.left.line.spoil_calls(
      [&, released = release.get_future().share()](const std::string& what) -> std::optional<Error> {
        if (what != "snapshot" || !first.exchange(false)) {
          return std::nullopt;
        }
        entered.set_value();
        released.wait();
        return fail(ErrorCode::DeadlineExceeded, "injected");
      });
  auto looks = std::async(std::launch::async, [&] { return run.host.observe(); });
  entered.get_future().wait();
  computers.left.line.cut();
  ASSERT_TRUE(run.told("left is lost"));
  computers.left.line.mend();
  ASSERT_TRUE(run.told("left is back"));
  {
    const Lock lock(run.mutex);
    run.events.clear();
  }
  release.set_value();
  EXPECT_EQ(looks.get().find_task(TaskId("a")), nullptr);
  EXPECT_TRUE(run.computer("left").reachable);
  EXPECT_TRUE(run.host.properties(TaskId("a")));
}

/// Breaks a line in the middle of calls, again and again, and mends it at once or when it has been tried in
/// vain.
class Interruptions {
 public:
  explicit Interruptions(testing::Line& line) : line_(line) {}
  void begin() {
    line_.spoil_calls([this](const std::string&) { return during_call(); });
    line_.on_attempt([this] { before_attempt(); });
  }
  void end() {
    line_.spoil_calls({});
    line_.on_attempt({});
    const Lock lock(mutex_);
    over_ = true;
    line_.mend();
  }
  [[nodiscard]] int count() const {
    const Lock lock(mutex_);
    return count_;
  }

 private:
  std::optional<Error> during_call() {
    const Lock lock(mutex_);
    if (over_ || !line_.up() || --calls_ > 0) {
      return std::nullopt;
    }
    ++count_;
    calls_ = 1 + static_cast<int>(random_() % 40);
    attempts_ = static_cast<int>(random_() % 4);
    line_.cut();
    if (attempts_ == 0) {
      line_.mend();
    }
    return random_() % 2 == 0 ? std::optional<Error>(fail(ErrorCode::Unavailable, "injected")) : std::nullopt;
  }
  void before_attempt() {
    const Lock lock(mutex_);
    if (!over_ && !line_.up() && --attempts_ < 0) {
      line_.mend();
    }
  }

  testing::Line& line_;
  mutable Mutex mutex_;  ///< protects everything below
  std::mt19937 random_{20261126};
  int calls_ = 20;    ///< until the line breaks
  int attempts_ = 0;  ///< that are in vain
  int count_ = 0;
  bool over_ = false;
};

TEST(DistributedTaskHost, AHostMayComeAndGoAtAnyTime) {
  Computers computers;
  Interruptions interruptions(computers.right.line);
  Commander run(computers, {}, 2ms);
  ASSERT_EQ(said(run.switch_to(kFirst)), "done");
  interruptions.begin();
  const TimePoint limit = later(kPatience);
  for (int i = 0; i < 10 || (interruptions.count() < 10 && RealClock::instance().now() < limit); ++i) {
    (void)run.switch_to(i % 2 == 0 ? kSecond : kFirst);
    (void)run.host.tasks();
    (void)run.host.computers();
  }
  interruptions.end();
  ASSERT_GE(interruptions.count(), 10);
  ASSERT_TRUE(eventually([&] { return run.computer("right").reachable; }));
  // A runtime plans with what failed transitions have left behind; here all of it is taken down.
  ASSERT_TRUE(eventually([&] {
    const bool done = run.switch_to(kFirst) && run.wrong(kFirst).empty();
    return done || (run.switch_to(none()) && false);
  })) << run.wrong(kFirst);
}

}  // namespace
}  // namespace segue::distributed
