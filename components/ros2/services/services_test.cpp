// SPDX-License-Identifier: Apache-2.0
#include "../topics/topics_test_support.hpp"

#include <segue/ros2/message_codec.hpp>

#include <future>

namespace ros2::testing {
namespace {

using segue::type::Value;
using Answer = segue::Result<Value>;

/// Values of std_srvs/srv/SetBool as CDR.
struct SetBool {
  segue::ros2::InterfaceLibrary library;
  segue::ros2::MessageCodec request =
      segue::ros2::MessageCodec::of(library, "std_srvs/srv/SetBool_Request").value();
  segue::ros2::MessageCodec response =
      segue::ros2::MessageCodec::of(library, "std_srvs/srv/SetBool_Response").value();
};

ValueMap client_properties(const std::string& timeout = "30s") {
  ValueMap map;
  map.append("service", "/lamp/set");
  map.append("type", "std_srvs/srv/SetBool");
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("timeout", timeout);
  return map;
}

class Services : public Topics {
 protected:
  Services() { peer->serve("/lamp/set", "std_srvs/srv/SetBool"); }

  static std::future<Answer> call(RunningTask& client, Value request) {
    return std::async(std::launch::async, [&client, request = std::move(request)] {
      return client.task().call("call", Value::map({{"request", request}}), soon());
    });
  }
  /// The next request to the peer; one without a number where none comes.
  Request next_request() {
    std::vector<Request> all;
    EXPECT_TRUE(eventually([&] { return !(all = peer->requests()).empty(); }));
    // As servers of both middlewares wait for it, since a response that is sent before would be lost.
    EXPECT_TRUE(eventually([&] { return peer->clients() > 0; }));
    return all.empty() ? Request{} : all.front();
  }
  void respond(const Request& request, bool success, const std::string& message) {
    peer->respond(
        request,
        set_bool.response.encode(Value::map({{"success", success}, {"message", message}}), "").value());
  }
  static std::string error_of(const Answer& answer) {
    return answer ? std::string("(none)") : segue::to_string(answer.error());
  }

  SetBool set_bool;
};

TEST_P(Services, ACallReturnsTheResponseOfTheServer) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  for (const bool data : {true, false}) {
    auto answer = call(client, Value::map({{"data", data}}));
    const Request request = next_request();
    EXPECT_EQ(set_bool.request.decode(request.message).value(), Value::map({{"data", data}}));
    respond(request, data, "the lamp is set");
    const Answer got = answer.get();
    ASSERT_TRUE(got) << error_of(got);
    EXPECT_EQ(*got, Value::map({{"success", data}, {"message", "the lamp is set"}}));
  }
  EXPECT_TRUE(eventually([&] { return client.task().call("servers", {}, soon()).value().as_int() == 1; }));
}

TEST_P(Services, CallsAtTheSameTimeGetTheirOwnResponses) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  std::vector<std::future<Answer>> answers;
  for (int i = 0; i < 8; ++i)
    answers.push_back(call(client, Value::map({{"data", i % 2 == 0}})));
  std::vector<Request> requests;
  ASSERT_TRUE(eventually([&] {
    for (Request& one : peer->requests())
      requests.push_back(std::move(one));
    return requests.size() == answers.size();
  }));
  std::ranges::reverse(requests);
  ASSERT_TRUE(eventually([&] { return peer->clients() > 0; }));
  for (const Request& one : requests)
    respond(one, set_bool.request.decode(one.message).value().find("data")->as_bool(), "");
  for (int i = 0; i < 8; ++i) {
    const Answer got = answers[static_cast<std::size_t>(i)].get();
    ASSERT_TRUE(got) << error_of(got);
    EXPECT_EQ(got->find("success")->as_bool(), i % 2 == 0);
  }
}

TEST_P(Services, AServerThatDoesNotAnswerEndsTheCallInTime) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties("10s"));
  // The server has to be found within the time, too.
  ASSERT_TRUE(eventually([&] { return client.task().call("servers", {}, soon()).value().as_int() == 1; }));
  auto answer = call(client, Value::map({{"data", true}}));
  const Request late = next_request();
  const Answer got = answer.get();
  EXPECT_THAT(error_of(got),
              HasSubstr("service /lamp/set has not answered in time; whether it does it is not known"));
  respond(late, true, "too late");
  auto next = call(client, Value::map({{"data", false}}));
  const Request request = next_request();
  respond(request, false, "in time");
  const Answer second = next.get();
  const std::string message = second ? second->find("message")->as_string() : error_of(second);
  EXPECT_THAT(message, HasSubstr("in time")) << "the response to the first call is not that to the second";
}

TEST_P(Services, AServerThatIsNotThereIsSaid) {
  peer->stop_serving();
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties("200ms"));
  EXPECT_THAT(error_of(call(client, Value::map({{"data", true}})).get()),
              HasSubstr("service /lamp/set has no server"));
}

TEST_P(Services, AServerThatComesDuringTheCallIsAsked) {
  peer->stop_serving();
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  auto answer = call(client, Value::map({{"data", true}}));
  peer->serve("/lamp/set", "std_srvs/srv/SetBool");
  respond(next_request(), true, "here I am");
  const Answer got = answer.get();
  ASSERT_TRUE(got) << error_of(got);
  EXPECT_EQ(got->find("message")->as_string(), "here I am");
}

TEST_P(Services, AStopEndsCallsInProgressAndAllowsNoOthers) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  auto answer = call(client, Value::map({{"data", true}}));
  const Request request = next_request();
  ASSERT_TRUE(client.task().stop(soon()));
  EXPECT_THAT(error_of(answer.get()), HasSubstr("the task stops"));
  EXPECT_FALSE(call(client, Value::map({{"data", true}})).get());
  EXPECT_THAT(peer->requests(), IsEmpty());
  respond(request, true, "to nobody");
}

TEST_P(Services, AMalformedResponseIsSaid) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  auto answer = call(client, Value::map({{"data", true}}));
  peer->respond(next_request(), {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{1}});
  EXPECT_THAT(error_of(answer.get()), HasSubstr("the response of service /lamp/set is malformed"));
}

TEST_P(Services, ARequestThatDoesNotFitIsNotSent) {
  RunningTask client("ros2::ServiceClient", "lamp");
  client.run(client_properties());
  EXPECT_THAT(error_of(call(client, Value::map({{"dat", true}})).get()), HasSubstr("request"));
  EXPECT_THAT(error_of(call(client, Value::map({{"data", "yes"}})).get()), HasSubstr("request.data"));
  EXPECT_THAT(peer->requests(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(, Services, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

}  // namespace
}  // namespace ros2::testing
