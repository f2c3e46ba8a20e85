// SPDX-License-Identifier: Apache-2.0
#include "../participant/participant.hpp"
#include "../peers/managed_peer.hpp"
#include "../topics/topics_test_support.hpp"

#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/parameter_value.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/type/json.hpp>

#include <support/logged_lines.hpp>

#include <future>

namespace ros2::testing {
namespace {

using segue::TaskState;
using segue::type::Value;
using Fault = ManagedPeer::Fault;
using Numbers = std::vector<int>;

ValueMap node_properties(const std::string& timeout = "60s") {
  ValueMap map;
  map.append("name", "/talker");
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("timeout", timeout);
  return map;
}

class ManagedNodes : public ::testing::TestWithParam<Middleware> {
 protected:
  static std::unique_ptr<Peer> make_peer() {
    return GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
  }
  /// The error of configuring it; empty where that works.
  std::string configure(const ValueMap& values) {
    const auto done = task.configure(values);
    return done ? std::string() : segue::to_string(done.error());
  }

  ManagedPeer node{make_peer};
  RunningTask task{"ros2::ManagedNode", "talker_node"};
};

TEST_P(ManagedNodes, AreDrivenByTheLifeCycleOfTheTask) {
  auto values = node_properties();
  values["parameters"] = Value::map({{"rate", 10}, {"pid", Value::map({{"order", 2}})}});
  EXPECT_EQ(configure(values), "");
  EXPECT_EQ(node.state(), 2);
  EXPECT_THAT(node.parameters(), ElementsAre("rate: 10", "pid.order: 2"));
  ASSERT_TRUE(task.task().start(soon()));
  EXPECT_EQ(node.state(), 3);
  ASSERT_TRUE(task.task().stop(soon()));
  EXPECT_EQ(node.state(), 2);
  ASSERT_TRUE(task.task().cleanup(soon()));
  EXPECT_EQ(node.state(), 1);
  EXPECT_EQ(node.transitions(), (Numbers{1, 3, 4, 2}));
}

TEST_P(ManagedNodes, AreTakenOverFromWhateverStateTheyAreIn) {
  node.set_state(3);
  EXPECT_EQ(configure(node_properties()), "");
  EXPECT_EQ(node.transitions(), (Numbers{4, 2, 1}))
      << "deactivated and cleaned up, since it is configured afresh";
}

TEST_P(ManagedNodes, ThatRefuseATransitionAreSaid) {
  node.set_fault(Fault::Refuses);
  EXPECT_THAT(configure(node_properties()),
              HasSubstr("node /talker refuses to configure; it is unconfigured"));
  EXPECT_EQ(task.task().state(), TaskState::PreOperational);
}

TEST_P(ManagedNodes, ThatLieAreSaid) {
  node.set_fault(Fault::SaysDoneOnly);
  EXPECT_THAT(configure(node_properties()),
              HasSubstr("node /talker says that it did configure; it is unconfigured"));
}

TEST_P(ManagedNodes, ThatFailInATransitionAreNotAskedAgain) {
  EXPECT_EQ(configure(node_properties()), "");
  node.set_fault(Fault::FailsToActivate);
  const auto started = task.task().start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(segue::to_string(started.error()),
              HasSubstr("node /talker failed to activate; it is unconfigured"));
  EXPECT_EQ(node.transitions(), (Numbers{1, 3}));
}

TEST_P(ManagedNodes, WhoseResponseIsLostAreReadAgain) {
  EXPECT_EQ(configure(node_properties("30s")), "");
  node.set_fault(Fault::AnswersNothing);
  EXPECT_TRUE(task.task().start(soon())) << "the state tells that it was done";
  EXPECT_EQ(node.state(), 3);
  node.set_fault(Fault::Malformed);
  EXPECT_TRUE(task.task().stop(soon()));
  EXPECT_EQ(task.task().state(), TaskState::Stopped);
  EXPECT_EQ(node.transitions(), (Numbers{1, 3, 4})) << "asked once for each";
}

TEST_P(ManagedNodes, ThatDieInConfigureAreSaid) {
  node.set_fault(Fault::DiesInConfigure);
  EXPECT_THAT(configure(node_properties("2s")), HasSubstr("/talker"));
  EXPECT_EQ(task.task().state(), TaskState::PreOperational);
}

TEST_P(ManagedNodes, ThatRefuseParametersAreNotConfigured) {
  auto values = node_properties();
  values["parameters"] = Value::map({{"unknown", 1}});
  EXPECT_THAT(configure(values),
              HasSubstr("node /talker refuses its parameters: parameter 'unknown' has not been declared"));
  EXPECT_EQ(node.state(), 1);
}

TEST_P(ManagedNodes, GetParametersWhileTheyRunOrRefuseThem) {
  EXPECT_EQ(configure(node_properties()), "");
  ASSERT_TRUE(task.task().start(soon()));
  const auto set = [&](const char* name, int value) {
    const auto done =
        task.task().set_properties(Value::map({{"parameters", Value::map({{name, value}})}}), soon());
    return done ? std::string() : segue::to_string(done.error());
  };
  EXPECT_EQ(set("rate", 20), "");
  EXPECT_THAT(node.parameters(), ElementsAre("rate: 20"));
  EXPECT_THAT(set("unknown", 1),
              HasSubstr("node /talker refuses its parameters: parameter 'unknown' has not been declared"));
  EXPECT_EQ(task.task().properties().find("parameters")->find("rate")->as_int(), 20);
  EXPECT_EQ(node.transitions(), (Numbers{1, 3})) << "it goes on";
}

class ManagedNodesWithParameters : public ManagedNodes {
 protected:
  /// Stays, as it does where other tasks use it, since each that leaves and joins again has to be found anew.
  const std::shared_ptr<Participant> participant =
      Participant::join({own_domain(), Range::Localhost}).value();

  static ValueMap with(const Value& parameters) {
    auto values = node_properties();
    values["parameters"] = parameters;
    return values;
  }
  std::string set_live(const Value& parameters) {
    const auto done = task.task().set_properties(Value::map({{"parameters", parameters}}), soon());
    return done ? std::string() : segue::to_string(done.error());
  }
  /// "rate 5, order 1"
  std::string now() const {
    return "rate " + std::to_string(node.value("rate")) + ", order " +
           std::to_string(node.value("pid.order"));
  }
};

const Value kNoParameters = Value::map({});
const Value kRate = Value::map({{"rate", 10}});
const Value kOtherRate = Value::map({{"rate", 20}});
const Value kOrder = Value::map({{"pid", Value::map({{"order", 2}})}});
const Value kBoth = Value::map({{"rate", 30}, {"pid", Value::map({{"order", 3}})}});

TEST_P(ManagedNodesWithParameters, HaveTheSameOnesWhateverRanBefore) {
  const std::vector<std::pair<Value, std::string>> controllers = {{kNoParameters, "rate 5, order 1"},
                                                                  {kRate, "rate 10, order 1"},
                                                                  {kOtherRate, "rate 20, order 1"},
                                                                  {kOrder, "rate 5, order 2"},
                                                                  {kBoth, "rate 30, order 3"}};
  for (const auto& [before, ignored] : controllers) {
    for (const auto& [after, expected] : controllers) {
      ASSERT_EQ(configure(with(before)), "");
      ASSERT_TRUE(task.task().start(soon()));
      ASSERT_EQ(set_live(after), "");
      EXPECT_EQ(now(), expected) << "live";
      ASSERT_TRUE(task.task().stop(soon()));
      ASSERT_TRUE(task.task().cleanup(soon()));
      EXPECT_EQ(now(), "rate 5, order 1") << "as it was found";
      ASSERT_EQ(configure(with(after)), "");
      EXPECT_EQ(now(), expected) << "configured anew";
      ASSERT_TRUE(task.task().cleanup(soon()));
    }
  }
}

TEST_P(ManagedNodesWithParameters, KeepWhatOthersHaveChanged) {
  ASSERT_EQ(configure(with(kBoth)), "");
  node.set_value("rate", 7);
  ASSERT_TRUE(task.task().start(soon()));
  EXPECT_EQ(set_live(kNoParameters), "");
  EXPECT_EQ(now(), "rate 7, order 1");
}

TEST_P(ManagedNodesWithParameters, HaveTheFormerOnesWhereTheyCannotBeConfigured) {
  node.set_fault(Fault::Refuses);
  EXPECT_THAT(configure(with(kBoth)), HasSubstr("refuses to configure"));
  EXPECT_EQ(node.parameters().size(), 4U) << "they were set, and set back";
  EXPECT_EQ(now(), "rate 5, order 1");
}

TEST_P(ManagedNodesWithParameters, OfTwoTasksHaveThoseOfTheOneThatIsLeft) {
  RunningTask first("ros2::Node", "first");
  RunningTask second("ros2::Node", "second");
  ASSERT_TRUE(first.configure(with(kRate)));
  ASSERT_TRUE(second.configure(with(kRate)));
  ASSERT_TRUE(first.task().cleanup(soon()));
  EXPECT_EQ(now(), "rate 10, order 1");
  ASSERT_TRUE(second.task().cleanup(soon()));
  EXPECT_EQ(now(), "rate 5, order 1");
}

TEST_P(ManagedNodesWithParameters, StayChangeableAfterAStop) {
  RunningTask other("ros2::Node", "other");
  ASSERT_TRUE(other.configure(with(kRate)));
  ASSERT_TRUE(other.task().start(soon()));
  ASSERT_TRUE(other.task().stop(soon()));
  EXPECT_EQ(now(), "rate 10, order 1") << "it is configured still";
  ASSERT_TRUE(other.task().start(soon()));
  ASSERT_TRUE(other.task().set_properties(Value::map({{"parameters", kNoParameters}}), soon()));
  EXPECT_EQ(now(), "rate 5, order 1");
}

/// A message of /parameter_events, as rclcpp sends it.
Bytes parameter_event(const std::string& node, const char* kind, int rate) {
  segue::ros2::InterfaceLibrary library;
  const auto codec = segue::ros2::MessageCodec::of(library, "rcl_interfaces/msg/ParameterEvent").value();
  const Value changed = Value::map({{"name", "rate"}, {"value", *segue::ros2::parameter_value(Value(rate))}});
  return codec.encode(Value::map({{"node", node}, {kind, Value::list({changed})}}), "event").value();
}

TEST_P(ManagedNodes, TellWhichParametersOthersHaveChanged) {
  segue::testing::LoggedLines lines;
  const segue::task::RealtimeLogDrain drain;
  auto values = node_properties();
  values["parameters"] = Value::map({{"rate", 10}});
  EXPECT_EQ(configure(values), "");
  ASSERT_TRUE(task.task().start(soon()));
  const auto other = make_peer();
  other->advertise({"/parameter_events", "rcl_interfaces/msg/ParameterEvent", "", {}});
  ASSERT_TRUE(eventually([&] { return other->subscriptions() == 1; }));
  const auto changed = [&] {
    return segue::type::to_json(task.task().call("changed_parameters", {}, soon()).value(), -1);
  };
  other->publish(parameter_event("/talker", "new_parameters", 10));
  other->publish(parameter_event("/other", "changed_parameters", 5));
  other->publish(parameter_event("/talker", "changed_parameters", 20));
  EXPECT_TRUE(eventually([&] { return changed() == R"(["rate is 20, not 10"])"; })) << changed();
  EXPECT_TRUE(lines.has({"node /talker: somebody else has changed a parameter: rate is 20, not 10"}));
  other->publish(parameter_event("/talker", "deleted_parameters", 20));
  EXPECT_TRUE(eventually([&] { return changed() == R"(["rate is not set, not 10"])"; })) << changed();
  other->publish(parameter_event("/talker", "changed_parameters", 20));
  EXPECT_TRUE(eventually([&] { return changed() == R"(["rate is 20, not 10"])"; }));
  ASSERT_TRUE(task.task().set_properties(Value::map({{"parameters", Value::map({{"rate", 20}})}}), soon()));
  EXPECT_EQ(changed(), "[]") << "that is what is wanted now";
}

TEST_P(ManagedNodes, ThatLeaveTheirStateBringAnException) {
  EXPECT_EQ(configure(node_properties()), "");
  ASSERT_TRUE(task.task().start(soon()));
  node.set_state(1);
  EXPECT_TRUE(eventually([&] { return task.task().state() == TaskState::Exception; }));
}

TEST_P(ManagedNodes, ThatAreThereTwiceBringAnException) {
  EXPECT_EQ(configure(node_properties()), "");
  ASSERT_TRUE(task.task().start(soon()));
  const ManagedPeer twin{make_peer};
  ASSERT_TRUE(eventually([&] { return task.task().state() == TaskState::Exception; }));
  EXPECT_THAT(task.task().error_message(),
              HasSubstr("node /talker is there twice, and both answer: end one"));
}

TEST_P(ManagedNodes, ThatAreNotSeenForAWhileGoOn) {
  EXPECT_EQ(configure(node_properties()), "");
  ASSERT_TRUE(task.task().start(soon()));
  node.hide(true);
  EXPECT_TRUE(eventually([&] { return task.task().state() == TaskState::RunTimeError; }));
  node.hide(false);
  EXPECT_TRUE(eventually([&] { return task.task().state() == TaskState::Running; }));
  EXPECT_EQ(node.transitions(), (Numbers{1, 3}));
}

INSTANTIATE_TEST_SUITE_P(, ManagedNodesWithParameters,
                         ::testing::Values(Middleware::FastDds, Middleware::Cyclone), middleware_name);
INSTANTIATE_TEST_SUITE_P(, ManagedNodes, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(ManyManagedNodes, AreConfiguredAtTheSameTimeAgainAndAgain) {
  constexpr std::size_t kNodes = 25;
  const auto make_peer = fast_peers_of_one_node(own_domain());
  std::vector<std::unique_ptr<ManagedPeer>> nodes;
  std::vector<std::unique_ptr<RunningTask>> tasks;
  for (std::size_t i = 0; i < kNodes; ++i) {
    nodes.push_back(std::make_unique<ManagedPeer>(make_peer, "/node_" + std::to_string(i)));
    tasks.push_back(std::make_unique<RunningTask>("ros2::ManagedNode", "task_" + std::to_string(i)));
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<std::future<segue::Result<void>>> done;
    for (std::size_t i = 0; i < kNodes; ++i) {
      auto values = node_properties();
      values["name"] = "/node_" + std::to_string(i);
      done.push_back(
          std::async(std::launch::async, [&task = *tasks[i], values] { return task.configure(values); }));
    }
    for (auto& one : done) {
      const auto result = one.get();
      EXPECT_TRUE(result) << segue::to_string(result.error());
    }
    for (const auto& task : tasks)
      ASSERT_TRUE(task->task().cleanup(soon()));
  }
}

TEST(ManagedNodeProperties, AreRefusedWithAReason) {
  const auto refusal = [](const char* name, Value value) {
    RunningTask task("ros2::ManagedNode", "talker_node");
    auto values = node_properties();
    values[name] = std::move(value);
    const auto done = task.configure(values);
    return done ? std::string() : segue::to_string(done.error());
  };
  EXPECT_THAT(refusal("name", "a b"), HasSubstr("'a b' is not a valid name of a node"));
  EXPECT_THAT(refusal("parameters", 3), HasSubstr("expected a map of parameters"));
  EXPECT_THAT(refusal("timeout", "0s"), HasSubstr("timeout must be positive"));
}

}  // namespace
}  // namespace ros2::testing
