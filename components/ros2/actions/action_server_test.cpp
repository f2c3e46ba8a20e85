// SPDX-License-Identifier: Apache-2.0
#include "../peers/action_client_peer.hpp"
#include "../topics/topics_test_support.hpp"

#include <optional>

namespace ros2::testing {
namespace {

using segue::type::Value;

enum GoalStatus {
  kUnknownGoal = 0,
  kIsWaiting = 1,
  kIsExecuting,
  kIsCanceling,
  kHasSucceeded,
  kWasCanceled,
  kWasAborted
};
enum CancelAnswer { kCancels, kDoesNotCancel, kKnowsNoSuchGoal, kGoalHasEnded };

/// The task that carries out goals.
class Counter final : public segue::task::Component {
 public:
  /// Its connections begin with commit().
  explicit Counter(RunningTask& server) {
    auto& component = server.task().component();
    bool connected = commit_.connect(*component.find_output("goal"), goal_) &&
                     commit_.connect(*component.find_output("cancel"), cancel_);
    for (segue::task::OutputPortBase* output : outputs()) {
      if (auto* input = component.find_input(output->name()); input != nullptr)
        connected = connected && commit_.connect(*output, *input);
    }
    if (!connected) std::abort();
  }
  void commit() { commit_.happen(); }
  /// The target of the next goal; nothing where none comes.
  std::optional<int> next() {
    std::optional<int> target;
    EXPECT_TRUE(eventually([&] { return (target = poll()).has_value(); }));
    return target;
  }
  std::optional<int> poll() {
    auto sample = goal_.take();
    return sample ? std::optional(sample->target) : std::nullopt;
  }
  /// Whether the latest goal gets to be canceled.
  bool is_canceled() {
    return eventually([&] {
      while (auto sample = cancel_.take())
        is_canceled_ = *sample;
      return is_canceled_;
    });
  }
  void tell(int now, const std::string& words = "on") { feedback_.write({now, words}); }
  void succeed(int reached, const std::string& words = "done") { succeeded_.write({reached, words}); }
  void end_canceled(int reached) { canceled_.write({reached, "done"}); }
  void abort(int reached) { aborted_.write({reached, "done"}); }

 private:
  segue::task::InputPort<test_msgs::Count_Goal> goal_{*this, "goal"};
  segue::task::InputPort<bool> cancel_{*this, "cancel"};
  segue::task::OutputPort<test_msgs::Count_Feedback> feedback_{*this, "feedback"};
  segue::task::OutputPort<test_msgs::Count_Result> succeeded_{*this, "succeeded"};
  segue::task::OutputPort<test_msgs::Count_Result> canceled_{*this, "canceled"};
  segue::task::OutputPort<test_msgs::Count_Result> aborted_{*this, "aborted"};
  bool is_canceled_ = false;
  Commit commit_;
};

ValueMap served_action(const segue::testing::TemporaryFiles& folder) {
  ValueMap map;
  map.append("action", "/count");
  map.append("type", kCount);
  map.append("interfaces", Value::list({folder.folder().string()}));
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("keep_result", "600s");
  return map;
}

class ServedActions : public ::testing::TestWithParam<Middleware> {
 protected:
  using Result = ActionClientPeer::Result;

  ServedActions() { define_count(folder.folder()); }

  void run(const std::string& property = "", Value value = {}) {
    ValueMap values = served_action(folder);
    if (!property.empty()) values[property] = std::move(value);
    server.run(values);
    counter.emplace(server);
    counter->commit();
  }
  std::unique_ptr<ActionClientPeer> make_client(Middleware middleware) {
    const auto cyclone = [] { return make_cyclone_peer(own_domain()); };
    auto made =
        middleware == Middleware::FastDds
            ? std::make_unique<ActionClientPeer>(fast_peers_of_one_node(own_domain()), folder.folder())
            : std::make_unique<ActionClientPeer>(cyclone, folder.folder());
    const auto expected = ++clients;
    EXPECT_TRUE(eventually([&] { return made->is_served() && server.count("clients") == expected; }));
    return made;
  }
  std::unique_ptr<ActionClientPeer> make_client() { return make_client(GetParam()); }
  std::unique_ptr<ActionClientPeer> make_other_client() {
    return make_client(GetParam() == Middleware::FastDds ? Middleware::Cyclone : Middleware::FastDds);
  }
  bool is(const std::string& state) {
    return eventually([&] { return server.task().state_name() == state; });
  }
  static bool shows(ActionClientPeer& client, const Value& id, int status) {
    return eventually([&] { return client.status(id) == status; });
  }
  /// Sends a goal that the counter gets.
  Value executed(ActionClientPeer& client, int number) {
    Value id = goal_id_of_byte(number);
    EXPECT_TRUE(client.send(id, number));
    EXPECT_EQ(counter->next(), number);
    return id;
  }

  segue::testing::TemporaryFiles folder;
  RunningTask server{"ros2::ActionServer", "counting"};
  std::optional<Counter> counter;
  std::uint64_t clients = 0;
};

TEST_P(ServedActions, AGoalIsCarriedOut) {
  run();
  const auto client = make_client();
  for (const int number : {3, 4}) {
    const Value id = executed(*client, number);
    EXPECT_TRUE(is("executing"));
    EXPECT_TRUE(shows(*client, id, kIsExecuting));
    const auto asked = client->ask_for_result(id);
    counter->succeed(number);
    EXPECT_EQ(client->result(asked), Result(kHasSucceeded, number)) << "asked before the end";
    EXPECT_EQ(client->result(id), Result(kHasSucceeded, number)) << "asked after the end";
    EXPECT_TRUE(is("succeeded"));
    EXPECT_TRUE(shows(*client, id, kHasSucceeded));
  }
  EXPECT_EQ(server.count("goals"), 2U);
}

TEST_P(ServedActions, GoalsAreRejectedBeforeTheCommit) {
  server.run(served_action(folder));
  counter.emplace(server);
  const auto client = make_client();
  EXPECT_FALSE(client->send(goal_id_of_byte(1), 1));
  counter->commit();
  executed(*client, 2);
}

TEST_P(ServedActions, FeedbackIsThatOfTheGoal) {
  run();
  const auto client = make_client();
  const Value id = executed(*client, 3);
  // Feedback from before the server has found the subscription is lost on the way.
  ASSERT_TRUE(eventually([&] {
    counter->tell(0);
    return !client->feedback(id).empty();
  }));
  counter->tell(1);
  counter->tell(2);
  counter->tell(9, std::string(kMostWords + 1, 'x'));
  counter->succeed(3);
  ASSERT_TRUE(eventually([&] { return client->feedback(id).back() == 2; }));
  const auto all = client->feedback(id);
  EXPECT_EQ(all.at(all.size() - 2), 1);
  EXPECT_EQ(client->result(id), Result(kHasSucceeded, 3));
  EXPECT_EQ(server.count("unsent"), 1U) << "feedback that exceeds a bound";
  counter->tell(5);
  EXPECT_TRUE(eventually([&] { return server.count("unasked") == 1; }));
}

TEST_P(ServedActions, ClientsOfBothMiddlewaresGetResults) {
  run();
  const auto client = make_client();
  const auto other = make_other_client();
  const Value id = executed(*client, 3);
  EXPECT_FALSE(other->send(goal_id_of_byte(4), 4)) << "one goal at a time";
  const auto asked = client->ask_for_result(id);
  const auto others = other->ask_for_result(id);
  counter->abort(2);
  EXPECT_EQ(client->result(asked), Result(kWasAborted, 2));
  EXPECT_EQ(other->result(others), Result(kWasAborted, 2));
  EXPECT_TRUE(shows(*other, id, kWasAborted));
  const Value next = executed(*other, 5);
  counter->succeed(5);
  EXPECT_EQ(other->result(next), Result(kHasSucceeded, 5));
  EXPECT_EQ(server.count("rejected"), 1U);
  EXPECT_EQ(counter->poll(), std::nullopt);
}

TEST_P(ServedActions, ACanceledGoalEndsWhenItsTaskSaysSo) {
  run();
  const auto client = make_client();
  const Value id = executed(*client, 3);
  const auto canceled = client->cancel(id);
  EXPECT_EQ(canceled.code, kCancels);
  EXPECT_THAT(canceled.goals, ElementsAre(id));
  EXPECT_TRUE(counter->is_canceled());
  EXPECT_TRUE(is("canceling"));
  EXPECT_TRUE(shows(*client, id, kIsCanceling));
  EXPECT_EQ(client->cancel(id).code, kGoalHasEnded) << "as rcl_action answers the second time";
  counter->end_canceled(1);
  EXPECT_EQ(client->result(id), Result(kWasCanceled, 1));
  EXPECT_TRUE(is("canceled"));
  EXPECT_EQ(client->cancel(id).code, kGoalHasEnded);
  const Value next = executed(*client, 4);
  EXPECT_EQ(client->cancel(next).code, kCancels);
  counter->succeed(4);
  EXPECT_EQ(client->result(next), Result(kHasSucceeded, 4)) << "it was reached all the same";
}

TEST_P(ServedActions, AGoalThatNobodyCanceledIsAborted) {
  run();
  const auto client = make_client();
  const Value id = executed(*client, 3);
  counter->end_canceled(1);
  EXPECT_EQ(client->result(id), Result(kWasAborted, 1));
}

TEST_P(ServedActions, RequestsToCancelNameGoalsByIdAndTime) {
  run();
  const auto client = make_client();
  EXPECT_EQ(client->cancel(goal_id_of_byte(7)).code, kKnowsNoSuchGoal);
  const auto none = client->cancel_all();
  EXPECT_EQ(none.code, kCancels);
  EXPECT_THAT(none.goals, IsEmpty());
  const Value id = executed(*client, 3);
  constexpr int kLongAgo = 1000;
  EXPECT_THAT(client->cancel(goal_id_of_byte(0), kLongAgo).goals, IsEmpty());
  EXPECT_THAT(client->cancel(id, kLongAgo).goals, ElementsAre(id)) << "it is named";
  counter->end_canceled(1);
  EXPECT_EQ(client->result(id), Result(kWasCanceled, 1));
  const Value next = executed(*client, 4);
  EXPECT_THAT(client->cancel_all().goals, ElementsAre(next));
  counter->end_canceled(2);
  EXPECT_EQ(client->result(next), Result(kWasCanceled, 2)) << "no goal is taken before";
  const Value last = executed(*client, 5);
  constexpr int kFarAhead = 2'000'000'000;
  EXPECT_THAT(client->cancel(goal_id_of_byte(0), kFarAhead).goals, ElementsAre(last));
}

TEST_P(ServedActions, AServerMayRefuseToCancel) {
  run("cancelable", false);
  const auto client = make_client();
  const Value id = executed(*client, 3);
  const auto canceled = client->cancel(id);
  EXPECT_EQ(canceled.code, kDoesNotCancel);
  EXPECT_THAT(canceled.goals, IsEmpty());
  counter->succeed(3);
  EXPECT_EQ(client->result(id), Result(kHasSucceeded, 3));
}

TEST_P(ServedActions, ANewGoalPreempts) {
  run("when_busy", "preempt");
  const auto client = make_client();
  const Value first = executed(*client, 1);
  const auto asked = client->ask_for_result(first);
  const Value second = goal_id_of_byte(2);
  const Value third = goal_id_of_byte(3);
  EXPECT_TRUE(client->send(second, 2));
  EXPECT_TRUE(counter->is_canceled());
  EXPECT_TRUE(shows(*client, first, kIsCanceling));
  EXPECT_EQ(client->status(second), kIsWaiting);
  EXPECT_TRUE(client->send(third, 3));
  EXPECT_EQ(client->result(second), Result(kWasCanceled, 0)) << "only the latest one waits";
  EXPECT_EQ(counter->poll(), std::nullopt) << "until the first has ended";
  counter->end_canceled(1);
  EXPECT_EQ(client->result(asked), Result(kWasCanceled, 1));
  EXPECT_EQ(counter->next(), 3);
  EXPECT_TRUE(is("executing"));
  counter->succeed(3);
  EXPECT_EQ(client->result(third), Result(kHasSucceeded, 3));
}

TEST_P(ServedActions, AGoalThatWaitsCanBeCanceled) {
  run("when_busy", "preempt");
  const auto client = make_client();
  const Value first = executed(*client, 1);
  const Value second = goal_id_of_byte(2);
  EXPECT_TRUE(client->send(second, 2));
  EXPECT_THAT(client->cancel(second).goals, ElementsAre(second));
  EXPECT_EQ(client->result(second), Result(kWasCanceled, 0));
  counter->succeed(1);
  EXPECT_EQ(client->result(first), Result(kHasSucceeded, 1));
  executed(*client, 3);
}

TEST_P(ServedActions, AnIdentifierIsTakenOnce) {
  run();
  const auto client = make_client();
  const Value id = executed(*client, 3);
  counter->succeed(3);
  EXPECT_EQ(client->result(id), Result(kHasSucceeded, 3));
  EXPECT_FALSE(client->send(id, 4));
  EXPECT_EQ(client->result(id), Result(kHasSucceeded, 3));
}

TEST_P(ServedActions, ResultsAreKeptForSomeTime) {
  run("keep_result", "1ms");
  const auto client = make_client();
  EXPECT_EQ(client->result(goal_id_of_byte(7)).status, kUnknownGoal) << "there was none";
  const Value id = executed(*client, 3);
  const auto asked = client->ask_for_result(id);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  counter->succeed(3);
  EXPECT_EQ(client->result(asked), Result(kHasSucceeded, 3));
  EXPECT_TRUE(eventually([&] { return client->result(id).status == kUnknownGoal; }));
}

TEST_P(ServedActions, RequestsForResultsAreBounded) {
  run();
  const auto client = make_client();
  const Value id = executed(*client, 3);
  std::int64_t last = 0;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    last = client->ask_for_result(id);
    ASSERT_TRUE(eventually([&] { return server.count("waiting") == i; }));
  }
  EXPECT_EQ(client->result(id).status, kUnknownGoal) << "one too many";
  EXPECT_EQ(server.count("refused"), 1U);
  counter->succeed(3);
  EXPECT_EQ(client->result(last), Result(kHasSucceeded, 3));
  EXPECT_TRUE(eventually([&] { return server.count("waiting") == 0; }));
}

TEST_P(ServedActions, MalformedRequestsAreDropped) {
  run();
  const auto client = make_client();
  client->send_to_all({std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{1}});
  EXPECT_TRUE(eventually([&] { return server.count("corrupt") == 3; }));
  Bytes cut = client->goal_request(goal_id_of_byte(1), 3);
  cut.resize(cut.size() - 4);
  client->send_goal_bytes(cut);
  EXPECT_TRUE(eventually([&] { return server.count("corrupt") == 4; }));
  EXPECT_FALSE(client->has_answer_to_goal());
  const Value id = executed(*client, 3);
  counter->succeed(3, std::string(kMostWords + 1, 'x'));
  EXPECT_EQ(client->result(id), Result(kWasAborted, 0)) << "its result exceeds a bound";
  EXPECT_EQ(server.count("unsent"), 1U);
}

TEST_P(ServedActions, AMalformedGoalDoesNotPreempt) {
  run("when_busy", "preempt");
  const auto client = make_client();
  const Value id = executed(*client, 3);
  Bytes cut = client->goal_request(goal_id_of_byte(1), 3);
  cut.resize(cut.size() - 4);
  client->send_goal_bytes(cut);
  EXPECT_TRUE(eventually([&] { return server.count("corrupt") == 1; }));
  EXPECT_EQ(server.task().state_name(), "executing");
  counter->succeed(3);
  EXPECT_EQ(client->result(id), Result(kHasSucceeded, 3));
}

TEST_P(ServedActions, AStopEndsTheGoalAsAborted) {
  run("when_busy", "preempt");
  const auto client = make_client();
  const Value id = executed(*client, 3);
  const Value waiting = goal_id_of_byte(4);
  EXPECT_TRUE(client->send(waiting, 4));
  const auto asked = client->ask_for_result(id);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  ASSERT_TRUE(server.task().stop(soon()));
  EXPECT_TRUE(counter->is_canceled());
  EXPECT_EQ(client->result(asked), Result(kWasAborted, 0));
  EXPECT_EQ(client->result(waiting), Result(kWasAborted, 0));
  EXPECT_TRUE(shows(*client, id, kWasAborted));
  EXPECT_FALSE(client->send(goal_id_of_byte(5), 5)) << "stopped";
  EXPECT_EQ(client->cancel(id).code, kGoalHasEnded);
  counter->succeed(3);
  ASSERT_TRUE(server.task().start(soon()));
  EXPECT_EQ(server.count("unasked"), 1U) << "it came too late";
  const Value next = executed(*client, 6);
  counter->succeed(6);
  EXPECT_EQ(client->result(next), Result(kHasSucceeded, 6));
}

TEST_P(ServedActions, AClientThatLeavesHindersNobody) {
  run();
  auto client = make_client();
  const auto other = make_other_client();
  const Value id = executed(*client, 3);
  client->ask_for_result(id);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  client.reset();
  ASSERT_TRUE(eventually([&] { return server.count("clients") == 1; }));
  clients = 1;
  const auto asked = other->ask_for_result(id);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 2; }));
  counter->succeed(3);
  EXPECT_EQ(other->result(asked), Result(kHasSucceeded, 3));
  const auto back = make_client();
  EXPECT_EQ(back->result(id), Result(kHasSucceeded, 3));
  EXPECT_TRUE(shows(*back, id, kHasSucceeded)) << "the status is latched";
}

INSTANTIATE_TEST_SUITE_P(, ServedActions, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(ActionServerProperties, AreRefusedWithAReason) {
  const segue::testing::TemporaryFiles folder;
  define_count(folder.folder());
  const auto refusal = [&](const char* name, Value value) {
    RunningTask task("ros2::ActionServer", "counting");
    ValueMap values = served_action(folder);
    values.append("when_busy", "preempt");
    values[name] = std::move(value);
    const auto done = task.configure(values);
    return done ? std::string() : segue::to_string(done.error());
  };
  EXPECT_THAT(refusal("action", "a b"), HasSubstr("'a b' is not a valid name"));
  EXPECT_THAT(refusal("type", "std_msgs/msg/String"), HasSubstr("is not an action"));
  EXPECT_THAT(refusal("when_busy", "queue"), HasSubstr("expected reject or preempt"));
  EXPECT_THAT(refusal("keep_result", "-1s"), HasSubstr("keep_result must not be negative"));
  EXPECT_THAT(refusal("cancelable", false), HasSubstr("set cancelable to true"));
}

TEST(ActionServerProperties, AWholeLifeCanBeRepeated) {
  const segue::testing::TemporaryFiles folder;
  define_count(folder.folder());
  RunningTask task("ros2::ActionServer", "counting");
  for (int i = 0; i < 3; ++i) {
    task.run(served_action(folder));
    EXPECT_EQ(task.task().state(), segue::TaskState::Running);
    ASSERT_TRUE(task.task().stop(soon()));
    ASSERT_TRUE(task.task().cleanup(soon()));
  }
}

}  // namespace
}  // namespace ros2::testing
