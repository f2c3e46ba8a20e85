// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/rpc/detail/wire.hpp>
#include <support/hostile_client.hpp>

#include <vector>

namespace segue::control {
namespace {

using type::Value;

TEST_F(ControlTest, GarbageIsRefusedAndOthersAreNotDisturbed) {
  serve();
  const auto good = client();
  send_garbage(socket_, [&] { return good->status().has_value(); });
}

TEST_F(ControlTest, AMessageThatClaimsToBeHugeIsRefusedBeforeItIsRead) {
  serve();
  const auto good = client();
  Raw one_segment(socket_);
  one_segment.send(word(0, 0x10000000));  // 2 GiB
  EXPECT_TRUE(one_segment.is_closed());
  Raw many_segments(socket_);
  many_segments.send(word(0x00FFFFFF, 1));
  EXPECT_TRUE(many_segments.is_closed());
  EXPECT_TRUE(good->status());
}

TEST_F(ControlTest, HalfAMessageAndSilenceAreCutOff) {
  serve();
  const auto good = client();
  Raw half(socket_);
  half.send(bootstrap_message(0).substr(0, 11));
  Raw silent(socket_);
  EXPECT_TRUE(half.is_closed());
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(good->status());
}

TEST_F(ControlTest, AClientThatOnlyTalksIsNotHeardForLong) {
  serve();
  const auto good = client();
  Raw hostile(socket_);
  const std::string flood = flood_of(200'000);
  // The server's queue and the two socket buffers fill up, then it reads no more.
  EXPECT_LT(hostile.send(flood, std::chrono::milliseconds(300)), flood.size() / 4);
  EXPECT_TRUE(good->status());
}

TEST_F(ControlTest, AnotherVersionIsToldBothVersions) {
  serve();
  Speaker other(socket_);
  const Error refused = other.hello(999, "robot");
  EXPECT_EQ(refused.code, ErrorCode::Unsupported);
  EXPECT_NE(refused.message.find("999"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("speaks version " + std::to_string(detail::kProtocolVersion) + " "),
            std::string::npos)
      << refused.message;
  EXPECT_EQ(Speaker(socket_).hello(detail::kProtocolVersion, "robot").message, "");
}

TEST_F(ControlTest, ArgumentsThatCannotBeDecodedAreRefused) {
  serve();
  Speaker speaker(socket_);
  ASSERT_EQ(speaker.hello(detail::kProtocolVersion, "robot").message, "");
  const Error bad_level = speaker.ask([](capnp::Capability::Client service) {
    auto request = service.castAs<wire::Robot>().watchRequest();
    request.initSeen().setState(200);
    return request.send().then([](auto&& response) { return detail::decode(response.getError()); });
  });
  EXPECT_EQ(bad_level.code, ErrorCode::ParseError) << to_string(bad_level);
  const Error bad_value = speaker.ask([](capnp::Capability::Client service) {
    auto request = service.castAs<wire::Robot>().callRequest();
    request.setOperation("wait");
    auto twice = request.initArguments().initMap(2);
    twice[0].setKey(detail::as_data("a"));
    twice[1].setKey(detail::as_data("a"));
    return request.send().then(
        [](auto&& response) { return detail::decode(response.getAnswer().getError()); });
  });
  EXPECT_EQ(bad_value.code, ErrorCode::ParseError) << to_string(bad_value);
  EXPECT_TRUE(client()->status());
}

TEST_F(ControlTest, AClientThatVanishesInACallLeavesTheServerWhole) {
  serve();
  Speaker doomed(socket_);
  ASSERT_EQ(doomed.hello(detail::kProtocolVersion, "robot").message, "");
  doomed.begin([](capnp::Capability::Client service) {
    auto request = service.castAs<wire::Robot>().callRequest();
    request.setOperation("wait");
    request.setTimeout(Duration(kLong).count());
    return request.send().ignoreResult();
  });
  ASSERT_TRUE(robot_.entered.wait());
  doomed.vanish();
  const auto good = client();
  EXPECT_TRUE(good->status());
  robot_.release.open();
  EXPECT_EQ(good->call("t", "wait", Value(), {}, soon()).value(), Value("released"));
}

TEST_F(ControlTest, TheSixtyFifthClientIsToldWhyAndTheOthersGoOn) {
  serve();
  const auto good = client();
  std::vector<decltype(client())> crowd;
  while (crowd.size() < 63)
    crowd.push_back(client());
  const auto refused = connect(socket_, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ResourceExhausted) << to_string(refused.error());
  EXPECT_NE(refused.error().message.find("refuses further connections (64 are open)"), std::string::npos)
      << refused.error().message;
  EXPECT_TRUE(good->status());
  crowd.clear();
  auto again = connect(socket_, kLong);
  for (const auto limit = soon(); !again && RealClock::instance().now() < limit;) {
    again = connect(socket_, kLong);
  }
  EXPECT_TRUE(again);
}

TEST_F(ControlTest, ClientsThatAreSilentKeepNobodyOut) {
  serve();
  const auto good = client();
  std::vector<std::unique_ptr<Raw>> crowd;
  while (crowd.size() < 300)
    crowd.push_back(std::make_unique<Raw>(socket_));
  EXPECT_TRUE(client()->status());
  EXPECT_TRUE(crowd.front()->is_closed()) << "the oldest one";
  EXPECT_TRUE(good->status());
}

}  // namespace
}  // namespace segue::control
