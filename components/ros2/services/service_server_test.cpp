// SPDX-License-Identifier: Apache-2.0
#include "../topics/topics_test_support.hpp"

#include <segue/ros2/message_codec.hpp>

#include <optional>

namespace std_srvs {
struct SetBool_Request {
  bool data = false;
};
struct SetBool_Response {
  bool success = false;
  std::string message;
};
}  // namespace std_srvs
SEGUE_TYPE(std_srvs::SetBool_Request, data)
SEGUE_TYPE(std_srvs::SetBool_Response, success, message)

namespace ros2::testing {
namespace {

using segue::type::Value;

ValueMap server_properties() {
  ValueMap map;
  map.append("service", "/lamp/set");
  map.append("type", "std_srvs/srv/SetBool");
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("timeout", "60s");
  return map;
}

/// The task that does what clients ask for.
class Lamp final : public segue::task::Component {
 public:
  explicit Lamp(RunningTask& server) : Lamp(server, std::make_unique<Commit>()) { commit(); }
  /// Its connections begin with commit().
  Lamp(RunningTask& server, std::unique_ptr<Commit> commit) : commit_(std::move(commit)) {
    auto& component = server.task().component();
    if (!commit_->connect(*component.find_output("request"), request_) ||
        !commit_->connect(response_, *component.find_input("response")))
      std::abort();
  }
  void commit() { commit_->happen(); }
  /// The next request; nothing where none comes.
  std::optional<bool> next() {
    std::optional<bool> data;
    EXPECT_TRUE(eventually([&] { return (data = poll()).has_value(); }));
    return data;
  }
  std::optional<bool> poll() {
    auto sample = request_.take();
    return sample ? std::optional(sample->data) : std::nullopt;
  }
  void answer(const std::string& message) { response_.write({true, message}); }

 private:
  segue::task::InputPort<std_srvs::SetBool_Request> request_{*this, "request"};
  segue::task::OutputPort<std_srvs::SetBool_Response> response_{*this, "response"};
  std::unique_ptr<Commit> commit_;
};

class Served : public Topics {
 protected:
  void meet(Peer& client) {
    client.use("/lamp/set", "std_srvs/srv/SetBool");
    ++clients;
    ASSERT_TRUE(eventually([&] { return client.servers() == 1 && server.count("clients") == clients; }));
  }
  std::int64_t ask(Peer& client, bool data) {
    return client.ask(request.encode(Value::map({{"data", data}}), "").value());
  }
  std::string response_to(Peer& client, std::int64_t number) {
    std::vector<Response> all;
    EXPECT_TRUE(eventually([&] { return !(all = client.responses()).empty(); }));
    if (all.size() != 1) return std::to_string(all.size()) + " responses";
    EXPECT_EQ(all.front().number, number);
    return response.decode(all.front().message).value().find("message")->as_string();
  }

  segue::ros2::InterfaceLibrary library;
  const segue::ros2::MessageCodec request =
      segue::ros2::MessageCodec::of(library, "std_srvs/srv/SetBool_Request").value();
  const segue::ros2::MessageCodec response =
      segue::ros2::MessageCodec::of(library, "std_srvs/srv/SetBool_Response").value();
  std::uint64_t clients = 0;
  RunningTask server{"ros2::ServiceServer", "lamp"};
};

TEST_P(Served, ClientsGetTheResponseOfTheTask) {
  server.run(server_properties());
  Lamp lamp(server);
  meet(*peer);
  for (const bool data : {true, false}) {
    const auto number = ask(*peer, data);
    EXPECT_EQ(lamp.next(), data);
    lamp.answer("the lamp is set");
    EXPECT_EQ(response_to(*peer, number), "the lamp is set");
  }
  EXPECT_EQ(server.count("requests"), 2U);
  EXPECT_TRUE(eventually([&] { return server.count("responses") == 2; }))
      << "they are counted when they are sent";
}

TEST_P(Served, ARequestWaitsForTheCommit) {
  server.run(server_properties());
  Lamp lamp(server, std::make_unique<Commit>());
  meet(*peer);
  const auto number = ask(*peer, true);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  lamp.commit();
  EXPECT_EQ(lamp.next(), true);
  lamp.answer("now");
  EXPECT_EQ(response_to(*peer, number), "now");
}

TEST_P(Served, ClientsOfBothMiddlewaresGetTheirOwnResponses) {
  server.run(server_properties());
  Lamp lamp(server);
  const auto other =
      GetParam() == Middleware::FastDds ? make_cyclone_peer(own_domain()) : make_fast_peer(own_domain());
  meet(*peer);
  meet(*other);
  const auto first = ask(*peer, true);
  EXPECT_EQ(lamp.next(), true);
  const auto second = ask(*other, false);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  EXPECT_FALSE(lamp.poll()) << "one at a time";
  lamp.answer("for the first");
  EXPECT_EQ(response_to(*peer, first), "for the first");
  EXPECT_EQ(lamp.next(), false);
  lamp.answer("for the second");
  EXPECT_EQ(response_to(*other, second), "for the second");
  EXPECT_THAT(peer->responses(), IsEmpty());
}

TEST_P(Served, ARequestThatIsNotAnsweredMakesWayForTheNext) {
  auto values = server_properties();
  values["timeout"] = "50ms";
  server.run(values);
  Lamp lamp(server);
  meet(*peer);
  ask(*peer, true);
  EXPECT_EQ(lamp.next(), true);
  ASSERT_TRUE(eventually([&] { return server.count("unanswered") == 1; }));
  lamp.answer("too late");
  ASSERT_TRUE(eventually([&] { return server.count("unasked") == 1; }));
  EXPECT_THAT(peer->responses(), IsEmpty());
  ask(*peer, false);
  EXPECT_EQ(lamp.next(), false);
}

TEST_P(Served, RequestsThatAreTooManyOrMalformedAreDropped) {
  auto values = server_properties();
  values["depth"] = 1;
  server.run(values);
  Lamp lamp(server);
  meet(*peer);
  const Bytes nothing = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  peer->ask(nothing);
  ASSERT_TRUE(eventually([&] { return server.count("corrupt") == 1; }));
  ask(*peer, true);
  EXPECT_EQ(lamp.next(), true);
  ask(*peer, true);
  ASSERT_TRUE(eventually([&] { return server.count("waiting") == 1; }));
  ask(*peer, false);
  ASSERT_TRUE(eventually([&] { return server.count("refused") == 1; }));
  lamp.answer("first");
  EXPECT_EQ(lamp.next(), true);
}

TEST_P(Served, NothingIsServedWhileTheTaskIsStopped) {
  server.run(server_properties());
  Lamp lamp(server);
  meet(*peer);
  ask(*peer, true);
  EXPECT_EQ(lamp.next(), true);
  ASSERT_TRUE(server.task().stop(soon()));
  lamp.answer("stopped");
  ask(*peer, true);
  ASSERT_TRUE(eventually([&] { return server.count("early") == 1; }));
  EXPECT_THAT(peer->responses(), IsEmpty());
  ASSERT_TRUE(server.task().start(soon()));
  ASSERT_TRUE(eventually([&] { return server.count("unasked") == 1; })) << "the connection has kept it";
  const auto number = ask(*peer, false);
  EXPECT_EQ(lamp.next(), false);
  lamp.answer("started");
  EXPECT_EQ(response_to(*peer, number), "started");
}

INSTANTIATE_TEST_SUITE_P(, Served, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

TEST(ServerProperties, AreRefusedWithAReason) {
  const auto refusal = [](const char* name, Value value) {
    RunningTask task("ros2::ServiceServer", "lamp");
    auto values = server_properties();
    values[name] = std::move(value);
    const auto done = task.configure(values);
    return done ? std::string() : segue::to_string(done.error());
  };
  EXPECT_THAT(refusal("service", "a b"), HasSubstr("'a b' is not a valid name of a service"));
  EXPECT_THAT(refusal("type", "std_srvs/srv/SetBol"), HasSubstr("SetBool"));
  EXPECT_THAT(refusal("timeout", "0s"), HasSubstr("timeout must be positive"));
}

}  // namespace
}  // namespace ros2::testing
