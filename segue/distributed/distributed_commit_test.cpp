// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/test_support.hpp>

namespace segue::distributed {
namespace {

/// The real time, but for one reading: whoever takes it finds that something has taken long, without anybody
/// waiting.
class ClockWithDelay final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override {
    const Lock lock(mutex_);
    const TimePoint real = RealClock::instance().now();
    return delayed_ == std::this_thread::get_id() ? (delayed_ = {}, real + delay_) : real;
  }
  void sleep_until(TimePoint when) override { RealClock::instance().sleep_until(when); }
  /// Of the next reading by this thread.
  void delay_this_thread(Duration delay) {
    const Lock lock(mutex_);
    delayed_ = std::this_thread::get_id();
    delay_ = delay;
  }

 private:
  mutable Mutex mutex_;  ///< protects both below
  mutable std::thread::id delayed_;
  Duration delay_{};
};

/// A host over kFirst that is about to go to kSecond, with trouble at the commit.
class CommitTrouble : public ::testing::Test {
 protected:
  CommitTrouble() { EXPECT_EQ(said(run_.switch_to(kFirst)), "done"); }
  DistributedOptions options() const {
    DistributedOptions options;
    options.promise = kPromise;
    options.clock = &clock_;
    return options;
  }
  std::string switched() { return said(run_.switch_to(kMore)); }
  /// The connections of kMore that kFirst lacks.
  [[nodiscard]] bool has(const char* to) const {
    const auto network = run_.host.condensed(run_.host.observe());
    return std::any_of(network.connections.begin(), network.connections.end(),
                       [&](const model::Connection& one) { return to_string(one.to) == to; });
  }
  void reconnect() {
    run_.computers.right.line.spoil_calls({});
    run_.computers.right.line.spoil_answers({});
  }

  static constexpr Duration kPromise = kPatience;
  static constexpr const char* kMore = R"(network: more
tasks:
  a: {component: test::A}
  b: {component: test::B}
  c: {component: test::C}
  d: {component: test::D}
deployments:
  p1: {process: p1, host: left, tasks: [a, b]}
  p2: {process: p2, host: right, tasks: [c]}
connections:
  - a.out -> b.fresh
  - c.out -> c.fresh
  - d.out -> d.fresh
  - a.out -> c.in
)";
  ClockWithDelay clock_;
  Computers computers_;
  Commander run_{computers_, options()};
};

TEST_F(CommitTrouble, WithoutOneVoteNobodyCommits) {
  for (const ErrorCode code : {ErrorCode::InvalidState, ErrorCode::DeadlineExceeded}) {
    computers_.right.line.spoil_call("vote", code);
    const auto done = switched();
    EXPECT_NE(done.find("'right' did not promise"), std::string::npos) << done;
    EXPECT_FALSE(has("b.fresh"));
    EXPECT_FALSE(has("d.fresh"));
    EXPECT_TRUE(has("b.in"));
    reconnect();
  }
}

TEST_F(CommitTrouble, AHostThatIsSilentAfterItsVoteIsNamed) {
  computers_.right.line.spoil_answer("commit", ErrorCode::DeadlineExceeded);
  const auto done = switched();
  EXPECT_NE(done.find("'right' did not confirm the commit"), std::string::npos) << done;
  EXPECT_TRUE(has("b.fresh"));
  EXPECT_FALSE(run_.computer("right").reachable) << "it counts as lost";
}

TEST_F(CommitTrouble, AProcessThatCannotBeArmedDoesNotLoseItsHost) {
  computers_.right.line.spoil_answer("arm_commit", ErrorCode::Unavailable);
  const auto done = switched();
  EXPECT_NE(done.find("'right' cannot prepare to commit"), std::string::npos) << done;
  EXPECT_TRUE(run_.computer("right").reachable);
  reconnect();
  EXPECT_EQ(switched(), "done");
  EXPECT_EQ(run_.wrong(kMore), "");
}

class LateCommit : public CommitTrouble {
 protected:
  /// Calls `pass_time` while a call of that name is on its way to the host on the right.
  void delay(const std::string& which, std::function<void()> pass_time) {
    computers_.right.line.spoil_calls(
        [which, pass_time = std::move(pass_time)](const std::string& what) -> std::optional<Error> {
          if (what == which) {
            pass_time();
          }
          return std::nullopt;
        });
  }
};

TEST_F(LateCommit, IsRefusedByTheHostThatGetsIt) {
  delay("commit", [&] { computers_.right.clock.advance(kPromise + 1s); });
  const auto done = switched();
  EXPECT_NE(done.find("'right'"), std::string::npos) << done;
  EXPECT_NE(done.find("too late"), std::string::npos) << done;
  EXPECT_FALSE(has("c.fresh"));
  EXPECT_TRUE(run_.computer("right").reachable) << "it has answered";
  reconnect();
  EXPECT_EQ(switched(), "done");
  EXPECT_EQ(run_.wrong(kMore), "");
}

TEST_F(LateCommit, DoesNotHappenWhereAPromiseCameLate) {
  // The promise of the others has nearly run out by then.
  delay("vote", [&] { clock_.delay_this_thread(kPromise - 1s); });
  const auto done = switched();
  EXPECT_NE(done.find("'right' did not promise"), std::string::npos) << done;
  EXPECT_FALSE(has("b.fresh")) << "nobody commits";
  EXPECT_FALSE(has("c.fresh"));
}

}  // namespace
}  // namespace segue::distributed
