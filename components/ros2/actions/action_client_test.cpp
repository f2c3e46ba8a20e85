// SPDX-License-Identifier: Apache-2.0
#include "../peers/action_peer.hpp"
#include "../topics/topics_test_support.hpp"

#include <future>

namespace ros2::testing {
namespace {

using segue::type::Value;
using GoalAnswer = segue::Result<Value>;

enum CancelCode { kAgrees, kRefuses, kUnknown, kHasEnded };
enum Status { kAccepted = 1, kExecuting, kCanceling, kSucceeded, kCanceled, kAborted };

/// Reads what an action's task writes.
class Followed final : public segue::task::Component {
 public:
  explicit Followed(RunningTask& client) {
    const segue::Policy plenty{segue::BufferKind::Buffer, 1000, segue::Transport::Automatic, false};
    auto& component = client.task().component();
    if (!segue::sample_link::connect(*component.find_output("result"), result_, plenty) ||
        !segue::sample_link::connect(*component.find_output("feedback"), feedback_, plenty))
      std::abort();
  }
  std::vector<std::int64_t> results() {
    std::vector<std::int64_t> all;
    while (auto sample = result_.take())
      all.push_back(sample->words == "done" ? sample->reached : -1);
    return all;
  }
  std::vector<int> feedback() {
    while (auto sample = feedback_.take())
      feedback_so_far_.push_back(sample->words == "on" ? sample->now : -1);
    return feedback_so_far_;
  }

 private:
  segue::task::InputPort<test_msgs::Count_Result> result_{*this, "result"};
  segue::task::InputPort<test_msgs::Count_Feedback> feedback_{*this, "feedback"};
  std::vector<int> feedback_so_far_;
};

ValueMap action_properties(const segue::testing::TemporaryFiles& folder) {
  ValueMap map;
  map.append("action", "/count");
  map.append("type", "test_msgs/action/Count");
  map.append("interfaces", Value::list({folder.folder().string()}));
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  return map;
}

class Actions : public ::testing::TestWithParam<Middleware> {
 protected:
  Actions() { define_count(folder.folder()); }

  static std::unique_ptr<Peer> make_peer() {
    return GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
  }
  std::unique_ptr<ActionPeer> make_server() const {
    return std::make_unique<ActionPeer>(make_peer, folder.folder());
  }
  ValueMap properties(const std::string& timeout = "60s") const {
    ValueMap map = action_properties(folder);
    map.append("timeout", timeout);
    return map;
  }
  std::future<GoalAnswer> send(int target) {
    return std::async(std::launch::async, [this, target] {
      return client.task().call("send_goal", Value::map({{"goal", Value::map({{"target", target}})}}),
                                soon());
    });
  }
  std::future<GoalAnswer> cancel() {
    return std::async(std::launch::async, [this] { return client.task().call("cancel", {}, soon()); });
  }
  std::future<segue::Result<void>> stop() {
    return std::async(std::launch::async, [this] { return client.task().stop(soon()); });
  }
  /// Whether the task gets to that state.
  bool is(const std::string& state) {
    return eventually([&] { return client.task().state_name() == state; });
  }
  /// Sends a goal, which the server accepts.
  ActionPeer::Asked accepted(ActionPeer& server, int target) {
    auto answer = send(target);
    auto goal = server.next_goal();
    EXPECT_EQ(goal.value.find("goal")->find("target")->as_int(), target);
    server.answer_goal(goal, true);
    const GoalAnswer got = answer.get();
    EXPECT_TRUE(got && got->as_bool()) << text_of_error(got);
    return goal;
  }
  template <class T>
  static std::string text_of_error(const segue::Result<T>& got) {
    return got ? std::string("(none)") : segue::to_string(got.error());
  }

  segue::testing::TemporaryFiles folder;
  RunningTask client{"ros2::ActionClient", "counter"};
};

TEST_P(Actions, AGoalIsFollowedToItsResult) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  std::vector<int> all_feedback;
  for (const int target : {3, 4}) {
    all_feedback.push_back(target);
    const auto goal = accepted(*server, target);
    EXPECT_TRUE(is("accepted")) << "not the state of an earlier goal";
    const auto asked = server->next_result_request();
    EXPECT_EQ(asked.id, goal.id);
    server->tell_status(goal.id, kExecuting);
    EXPECT_TRUE(is("executing"));
    server->tell_feedback(goal.id, target);
    EXPECT_TRUE(eventually([&] { return followed.feedback() == all_feedback; }));
    server->answer_result(asked, kSucceeded, target);
    EXPECT_TRUE(is("succeeded"));
    EXPECT_THAT(followed.results(), ElementsAre(target)) << "before the state";
  }
}

TEST_P(Actions, WithoutAServerAreSaid) {
  client.run(properties("200ms"));
  EXPECT_THAT(text_of_error(send(3).get()), HasSubstr("action /count has no server"));
  EXPECT_THAT(text_of_error(cancel().get()), HasSubstr("has no goal that could be canceled"));
}

TEST_P(Actions, WithTwoServersGetNoGoal) {
  const auto server = make_server();
  const auto other = make_server();
  client.run(properties());
  ASSERT_TRUE(eventually([&] { return client.count("servers") == 2; }));
  EXPECT_THAT(text_of_error(send(3).get()), HasSubstr("action /count has 2 servers"));
}

TEST_P(Actions, WhoseServerRefusesTellThat) {
  const auto server = make_server();
  client.run(properties());
  auto answer = send(3);
  server->answer_goal(server->next_goal(), false);
  const GoalAnswer got = answer.get();
  ASSERT_TRUE(got) << text_of_error(got);
  EXPECT_FALSE(got->as_bool());
  EXPECT_TRUE(is("refused"));
  EXPECT_TRUE(client.task().stop(soon()));
  EXPECT_EQ(server->cancels(), 0U);
}

TEST_P(Actions, AGoalThatIsAcceptedTooLateIsCanceled) {
  const auto server = make_server();
  client.run(properties("10s"));
  ASSERT_TRUE(eventually([&] { return client.count("servers") == 1; }));
  auto answer = send(3);
  const auto goal = server->next_goal();
  EXPECT_THAT(text_of_error(answer.get()), HasSubstr("has not answered in time"));
  EXPECT_TRUE(is("lost"));
  server->answer_goal(goal, true);
  EXPECT_EQ(server->next_cancel().id, goal.id);
}

TEST_P(Actions, AMalformedAnswerIsSaid) {
  const auto server = make_server();
  client.run(properties());
  auto answer = send(3);
  server->answer_goal_malformed(server->next_goal());
  EXPECT_THAT(text_of_error(answer.get()), HasSubstr("has not answered with a message of its type"));
  EXPECT_TRUE(is("lost"));
}

TEST_P(Actions, AStopCancelsTheGoalAndWaitsForItsEnd) {
  const auto server = make_server();
  client.run(properties());
  const auto goal = accepted(*server, 3);
  const auto asked = server->next_result_request();
  auto stopped = stop();
  const auto cancel = server->next_cancel();
  EXPECT_EQ(cancel.id, goal.id);
  server->answer_cancel(cancel, kAgrees);
  EXPECT_EQ(stopped.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  server->answer_result(asked, kCanceled, 1);
  EXPECT_TRUE(stopped.get());
  EXPECT_EQ(client.task().state(), segue::TaskState::Stopped);
  EXPECT_THAT(text_of_error(send(4).get()), HasSubstr("the task stops"));
  ASSERT_TRUE(client.task().start(soon()));
  const auto next = accepted(*server, 5);
  EXPECT_NE(next.id, goal.id);
  auto again = stop();
  server->answer_cancel(server->next_cancel(), kHasEnded);
  server->answer_result(server->next_result_request(), kSucceeded, 5);
  EXPECT_TRUE(again.get());
}

TEST_P(Actions, AStopDoesNotWaitForAServerThatRefusesToCancel) {
  const auto server = make_server();
  client.run(properties("600s"));
  static_cast<void>(accepted(*server, 3));
  auto stopped = stop();
  server->answer_cancel(server->next_cancel(), kRefuses);
  static_cast<void>(stopped.get());
  EXPECT_EQ(client.task().state(), segue::TaskState::Exception);
  EXPECT_THAT(client.task().error_message(), HasSubstr("refuses to cancel the goal"));
}

TEST_P(Actions, AStopGivesUpAGoalThatDoesNotEnd) {
  const auto server = make_server();
  client.run(properties("10s"));
  ASSERT_TRUE(eventually([&] { return client.count("servers") == 1; }));
  static_cast<void>(accepted(*server, 3));
  auto stopped = stop();
  server->answer_cancel(server->next_cancel(), kAgrees);
  static_cast<void>(stopped.get());
  EXPECT_THAT(client.task().error_message(), HasSubstr("cancels the goal, but has not ended it in time"));
}

TEST_P(Actions, ACanceledGoalEndsWhenTheServerHasEndedIt) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  const auto goal = accepted(*server, 3);
  const auto asked = server->next_result_request();
  auto refused = cancel();
  server->answer_cancel(server->next_cancel(), kRefuses);
  EXPECT_THAT(text_of_error(refused.get()), HasSubstr("refuses to cancel the goal"));
  EXPECT_TRUE(is("accepted"));
  auto agreed = cancel();
  server->answer_cancel(server->next_cancel(), kAgrees);
  EXPECT_TRUE(agreed.get());
  server->tell_status(goal.id, kCanceling);
  EXPECT_TRUE(is("canceling"));
  server->answer_result(asked, kCanceled, 2);
  EXPECT_TRUE(is("canceled"));
  EXPECT_THAT(followed.results(), ElementsAre(2));
}

TEST_P(Actions, AResultThatComesLateIsWaitedFor) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  const auto goal = accepted(*server, 3);
  server->tell_status(goal.id, kAborted);
  EXPECT_TRUE(is("executing"));
  server->answer_result(server->next_result_request(), kAborted, 2);
  EXPECT_TRUE(is("aborted"));
  EXPECT_THAT(followed.results(), ElementsAre(2));
}

TEST_P(Actions, AMalformedResultLeavesTheGoalLost) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  for (const bool malformed : {true, false}) {
    static_cast<void>(accepted(*server, 3));
    const auto asked = server->next_result_request();
    if (malformed) {
      server->answer_result_malformed(asked);
    } else {
      server->answer_result(asked, 0, 3);
    }
    EXPECT_TRUE(is("lost"));
  }
  EXPECT_THAT(followed.results(), IsEmpty());
}

TEST_P(Actions, OnlyFeedbackOfTheOwnGoalArrives) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  const auto goal = accepted(*server, 3);
  Value other = goal.id;
  other.as_map()["uuid"].as_list().front() = (other.find("uuid")->as_list().front().as_int() + 1) % 256;
  server->tell_feedback(other, 1);
  server->tell_status(other, kCanceling);
  server->tell_malformed_feedback(goal.id);
  server->tell_feedback(goal.id, 2);
  EXPECT_TRUE(eventually([&] { return !followed.feedback().empty(); }));
  EXPECT_THAT(followed.feedback(), ElementsAre(2));
  EXPECT_EQ(client.count("corrupt"), 2U);
  EXPECT_EQ(client.count("feedback"), 1U);
  server->tell_status(goal.id, kExecuting);
  EXPECT_TRUE(is("executing"));
}

TEST_P(Actions, WhoseServerLeavesAreLostUntilItComesBack) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  const auto goal = accepted(*server, 3);
  static_cast<void>(server->next_result_request());
  server->leave();
  EXPECT_TRUE(is("lost"));
  server->serve();
  ASSERT_TRUE(eventually([&] { return client.count("servers") == 1; }));
  // A status that is told before the client has found its publisher is lost on the way, since that is a new
  // one.
  ASSERT_TRUE(eventually([&] {
    server->tell_status(goal.id, kExecuting);
    return client.task().state_name() == "executing";
  }));
  server->tell_status(goal.id, kSucceeded);
  server->answer_result(server->next_result_request(), kSucceeded, 3);
  EXPECT_TRUE(is("succeeded"));
  EXPECT_THAT(followed.results(), ElementsAre(3));
}

TEST_P(Actions, ANewGoalTakesThePlaceOfTheEarlierOne) {
  const auto server = make_server();
  client.run(properties());
  Followed followed(client);
  const auto earlier = accepted(*server, 3);
  const auto earlier_asked = server->next_result_request();
  const auto later = accepted(*server, 4);
  EXPECT_EQ(server->next_cancel().id, earlier.id);
  server->answer_result(earlier_asked, kCanceled, 1);
  server->answer_result(server->next_result_request(), kSucceeded, 4);
  EXPECT_TRUE(is("succeeded"));
  EXPECT_THAT(followed.results(), ElementsAre(4));
  EXPECT_NE(later.id, earlier.id);
}

INSTANTIATE_TEST_SUITE_P(, Actions, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(ActionProperties, AreRefusedWithAReason) {
  const segue::testing::TemporaryFiles folder;
  define_count(folder.folder());
  const auto refusal = [&](const char* name, Value value) {
    RunningTask task("ros2::ActionClient", "counter");
    ValueMap values = action_properties(folder);
    values[name] = std::move(value);
    const auto done = task.configure(values);
    return done ? std::string() : segue::to_string(done.error());
  };
  EXPECT_THAT(refusal("action", "a b"), HasSubstr("'a b' is not a valid name"));
  EXPECT_THAT(refusal("type", "test_msgs/action/Cound"), HasSubstr("Count"));
  EXPECT_THAT(refusal("type", "std_msgs/msg/String"), HasSubstr("is not an action"));
  EXPECT_THAT(refusal("timeout", "0s"), HasSubstr("timeout must be positive"));
}

TEST(ActionProperties, FitTheGoalThatIsSent) {
  const segue::testing::TemporaryFiles folder;
  define_count(folder.folder());
  RunningTask task("ros2::ActionClient", "counter");
  task.run(action_properties(folder));
  const auto got = task.task().call("send_goal", Value::map({{"goal", Value::map({{"tarket", 3}})}}), soon());
  ASSERT_FALSE(got);
  EXPECT_THAT(segue::to_string(got.error()), HasSubstr("goal"));
  EXPECT_THAT(segue::to_string(got.error()), HasSubstr("tarket"));
}

}  // namespace
}  // namespace ros2::testing
