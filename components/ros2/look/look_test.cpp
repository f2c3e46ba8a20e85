// SPDX-License-Identifier: Apache-2.0
#include "look.hpp"
#include "../peers/node_peer.hpp"
#include "../peers/typed_peer.hpp"
#include "../topics/topics_test_support.hpp"
#include "local_process.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace ros2::testing {
namespace {

using segue::type::Value;
using LookFault = NodePeer::Fault;

class Looks : public ::testing::TestWithParam<Middleware> {
 protected:
  static std::function<std::unique_ptr<Peer>()> peers() {
    if (GetParam() == Middleware::FastDds) return fast_peers_of_one_node(own_domain());
    return [] { return make_cyclone_peer(own_domain()); };
  }
  /// Ends when the node has been found.
  static Look at(const std::string& node) {
    Look request;
    request.domain = static_cast<std::int32_t>(own_domain());
    request.discovery = "localhost";
    request.wait = request.patience = std::chrono::seconds(120);
    request.nodes = {node};
    return request;
  }
  /// The description of /lidar; until all of its endpoints are seen, since its parts come one by one.
  static Value lidar(const Look& request) {
    Value found;
    static_cast<void>(eventually([&] {
      const auto seen = look(request, {});
      EXPECT_TRUE(seen) << segue::to_string(seen.error());
      for (const Value& node : seen ? seen->find("nodes")->as_list() : Value::List()) {
        if (node.find("name")->as_string() == "/lidar") found = node;
      }
      return !seen || (found.is_map() && found.find("services")->as_list().size() == 7 &&
                       !found.find("publishers")->as_list().empty());
    }));
    return found;
  }
  /// The description of /dock, with its types, in the same way; `topics` are those of the node itself.
  static Value dock(std::size_t topics = 0) {
    Look request = at("/dock");
    request.types = true;
    Value found;
    static_cast<void>(eventually([&] {
      const auto seen = look(request, {});
      EXPECT_TRUE(seen) << segue::to_string(seen.error());
      for (const Value& node : seen ? seen->find("nodes")->as_list() : Value::List()) {
        if (node.find("name")->as_string() == "/dock") found = node;
      }
      const auto count = [&](const char* key) { return found.find(key)->as_list().size(); };
      return !seen || (found.is_map() && count("services") == 2 && count("actions") == 1 &&
                       count("publishers") == topics && has_all_hashes(found));
    }));
    return found;
  }
  /// Of the action; its services and its topic are found one by one.
  static bool has_all_hashes(const Value& node) {
    const Value* hashes = node.find("actions")->as_list().front().find("hashes");
    std::size_t found = 0;
    for (const char* part : {"SendGoal_Request", "SendGoal_Response", "GetResult_Request",
                             "GetResult_Response", "FeedbackMessage"})
      found += hashes->find("dock_msgs/action/Run_" + std::string(part)) != nullptr ? 1 : 0;
    return found == 5;
  }
  static std::string problems_of(const Value& node) {
    std::string all;
    for (const Value& problem : node.find("problems")->as_list())
      all += problem.as_string() + "\n";
    return all;
  }
  static Value parameter(const Value& node, const std::string& name) {
    for (const Value& one : node.find("parameters")->as_list()) {
      if (one.find("name")->as_string() == name) return one;
    }
    return Value::map({});
  }
};

TEST_P(Looks, DescribeANodeWithItsStateAndParameters) {
  NodePeer peer(peers());
  const Value node = lidar(at("/lidar"));
  EXPECT_EQ(*node.find("managed"), Value(true));
  EXPECT_EQ(*node.find("state"), Value("active"));
  EXPECT_EQ(*node.find("problems"), Value(Value::List()));
  EXPECT_EQ(*node.find("process")->find("pid"), Value(std::int64_t{::getpid()}));
  const Value& scan = node.find("publishers")->as_list().front();
  EXPECT_EQ(*scan.find("type"), Value("lidar_msgs/msg/Sweep"));
  EXPECT_EQ(*scan.find("hash"), Value(peer.hash()));
  EXPECT_EQ(*scan.find("quality")->find("reliability"), Value("best_effort"));
  EXPECT_EQ(parameter(node, "rate"),
            Value::map({{"name", "rate"},
                        {"kind", "integer"},
                        {"value", 10},
                        {"read_only", false},
                        {"description", "scans a second"},
                        {"constraints", ""},
                        {"range", Value::map({{"from", 1}, {"to", 40}, {"step", 1}})}}));
  EXPECT_EQ(*parameter(node, "serial").find("read_only"), Value(true));
  EXPECT_EQ(*parameter(node, "offsets").find("value"), Value::list({0.5, 1.0}));
}

TEST_P(Looks, FindTypesThatAreNotBuiltIn) {
  NodePeer peer(peers());
  Look request = at("/lidar");
  request.types = true;
  const Value node = lidar(request);
  EXPECT_EQ(*node.find("files"),
            Value::map({{"lidar_msgs/msg/Sweep.msg", "std_msgs/Header header\nfloat32[<=720] ranges\n"}}));
}

TEST_P(Looks, FindTypesOfServicesAndActions) {
  TypedPeer peer(peers(), TypedPeer::Release::Lyrical);
  const Value node = dock();
  EXPECT_EQ(problems_of(node), "");
  EXPECT_EQ(*node.find("files"),
            Value::map({{"dock_msgs/action/Run.action",
                         "dock_msgs/Side side\n---\nbool docked\n---\nfloat32 distance\n"},
                        {"dock_msgs/msg/Side.msg", "string name\n"},
                        {"dock_msgs/srv/Ask.srv", "dock_msgs/Side side\n---\n"}}));
}

TEST_P(Looks, FindTypesOfServicesByTheirEvents) {
  TypedPeer peer(peers(), TypedPeer::Release::JazzyIntrospected);
  const Value node = dock(1);
  EXPECT_EQ(*node.find("files"), Value::map({{"dock_msgs/msg/Side.msg", "string name\n"},
                                             {"dock_msgs/srv/Ask.srv", "dock_msgs/Side side\n---\n"}}));
  EXPECT_THAT(problems_of(node),
              HasSubstr("type dock_msgs/action/Run is not built in, and the node does not tell it"));
}

TEST_P(Looks, SayThatTypesOfServicesAreNotTold) {
  TypedPeer peer(peers(), TypedPeer::Release::Jazzy);
  const Value node = dock();
  EXPECT_EQ(*node.find("files"), Value::map({}));
  EXPECT_THAT(problems_of(node),
              HasSubstr("type dock_msgs/srv/Ask is not built in, and the node does not tell it, as nodes do "
                        "from Lyrical on: name a folder with its package"));
}

TEST_P(Looks, RefuseServicesThatAreNotOfTheHashesOfTheirEndpoints) {
  TypedPeer peer(peers(), TypedPeer::Release::Wrong);
  const Value node = dock();
  EXPECT_EQ(*node.find("files"), Value::map({}));
  EXPECT_THAT(problems_of(node),
              HasSubstr("type dock_msgs/srv/Ask: what the node tells of dock_msgs/srv/Ask_Response is "
                        "another type"));
}

TEST_P(Looks, RefuseATypeThatIsNotTheOneThatWasAnnounced) {
  NodePeer peer(peers(), LookFault::TellsAnotherType);
  Look request = at("/lidar");
  request.types = true;
  const Value node = lidar(request);
  EXPECT_EQ(*node.find("files"), Value::map({}));
  ASSERT_EQ(node.find("problems")->as_list().size(), 1U);
  EXPECT_THAT(node.find("problems")->as_list().front().as_string(),
              HasSubstr("what the node tells of lidar_msgs/msg/Sweep is another type"));
}

TEST_P(Looks, SayWhatANodeDoesNotAnswerAndShowTheRest) {
  NodePeer peer(peers(), LookFault::HidesParameters);
  Look request = at("/lidar");
  request.patience = std::chrono::seconds(10);
  const Value node = lidar(request);
  EXPECT_EQ(*node.find("state"), Value("active"));
  EXPECT_EQ(*node.find("parameters"), Value(Value::List()));
  ASSERT_EQ(node.find("problems")->as_list().size(), 1U);
  EXPECT_THAT(node.find("problems")->as_list().front().as_string(),
              HasSubstr("parameters: service /lidar/list_parameters has not answered in time"));
}

TEST_P(Looks, SayThatAnswersDoNotFitTogether) {
  NodePeer peer(peers(), LookFault::LosesParameters);
  const Value node = lidar(at("/lidar"));
  ASSERT_EQ(node.find("problems")->as_list().size(), 1U);
  EXPECT_THAT(node.find("problems")->as_list().front().as_string(), HasSubstr("does not answer for each"));
}

TEST_P(Looks, SayThatANodeIsNotThere) {
  Look request = at("/nobody");
  request.wait = std::chrono::milliseconds(100);
  EXPECT_THAT(segue::to_string(look(request, {}).error()), HasSubstr("no node '/nobody'; no node was"));
  NodePeer peer(peers());
  lidar(at("/lidar"));
  EXPECT_TRUE(eventually([&] {
    const std::string why = segue::to_string(look(request, {}).error());
    return why.find("no node '/nobody'; there are /lidar") != std::string::npos;
  }));
}

TEST_P(Looks, ThatAreBriefEndWhenNoMoreNodesAreFound) {
  NodePeer peer(peers());
  Look request = at("/lidar");
  request.nodes = {};
  request.brief = true;
  request.wait = std::chrono::hours(1);
  const auto seen = look(request, {});
  ASSERT_TRUE(seen);
  EXPECT_EQ(*seen->find("domain"), Value(std::int64_t{own_domain()}));
  ASSERT_EQ(seen->find("nodes")->as_list().size(), 1U);
  EXPECT_EQ(*seen->find("nodes")->as_list().front().find("name"), Value("/lidar"));
}

TEST_P(Looks, EndWhenTheyAreStopped) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(look(at("/nobody"), stop.get_token()).error().code, segue::ErrorCode::Cancelled);
}

/// Sockets of DDS are inherited by whatever a node starts, such as by the commands that these tests run.
TEST(LocalProcess, OfASocketIsTheOneFromWhichChildrenHaveIt) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::pause();
    ::_exit(0);
  }
  EXPECT_EQ(first_of({child, ::getpid()}), ::getpid());
  EXPECT_EQ(first_of({::getpid(), child}), ::getpid());
  EXPECT_EQ(first_of({child}), child);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(first_of({child}), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(, Looks, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(Look, IsReadFromARequest) {
  const auto request = parse_look(Value::map({{"domain", 7},
                                              {"discovery", "localhost"},
                                              {"wait", "2s"},
                                              {"nodes", Value::list({"/a"})},
                                              {"types", true}}));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->domain, 7);
  EXPECT_EQ(request->wait, std::chrono::seconds(2));
  EXPECT_EQ(request->nodes, Texts{"/a"});
  EXPECT_TRUE(request->types);
  EXPECT_FALSE(request->all);
  EXPECT_FALSE(parse_look(Value::map({{"wait", "soon"}})));
}

}  // namespace
}  // namespace ros2::testing
