// SPDX-License-Identifier: Apache-2.0
#include <segue/control/robot.capnp.h>
#include <segue/control/detail/event_loop.hpp>
#include <segue/control/detail/socket.hpp>
#include <segue/control/detail/wire.hpp>
#include <support/fake_robot.hpp>

#include <capnp/message.h>
#include <capnp/rpc-twoparty.h>
#include <capnp/rpc.capnp.h>
#include <capnp/serialize.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstring>
#include <future>
#include <random>
#include <vector>

namespace segue::control {
namespace {

using type::Value;

/// A client that does not speak the protocol.
class Raw {
 public:
  explicit Raw(const std::filesystem::path& socket)
      : descriptor_(detail::connect_socket(socket, kLong).value()) {}

  /// How much the server takes before it closes or stops reading for `patience`.
  std::size_t send(std::string_view bytes, Duration patience = kLong) {
    std::size_t total = 0;
    while (total < bytes.size()) {
      const auto sent = ::send(descriptor_.get(), bytes.data() + total, bytes.size() - total, MSG_NOSIGNAL);
      if (sent > 0) {
        total += static_cast<std::size_t>(sent);
      } else if (errno != EAGAIN || !wait_for(POLLOUT, patience)) {
        break;
      }
    }
    return total;
  }

  /// Whether the server closes in time; what it says before is dropped.
  bool is_closed() {
    char buffer[4096];
    for (;;) {
      const auto got = ::recv(descriptor_.get(), buffer, sizeof buffer, 0);
      if (got == 0 || (got < 0 && errno != EAGAIN)) return true;
      if (got < 0 && !wait_for(POLLIN, kLong)) return false;
    }
  }

 private:
  bool wait_for(short events, Duration limit) {
    pollfd entry{descriptor_.get(), events, 0};
    const auto limit_ms = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
    return ::poll(&entry, 1, static_cast<int>(limit_ms)) > 0;
  }
  Descriptor descriptor_;
};

/// Eight bytes: the begin of a message.
std::string word(std::uint32_t low, std::uint32_t high) {
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &low, 4);
  std::memcpy(bytes.data() + 4, &high, 4);
  return bytes;
}

/// A request for the bootstrap capability, which the server answers.
std::string bootstrap_message(std::uint32_t question) {
  capnp::MallocMessageBuilder message;
  message.initRoot<capnp::rpc::Message>().initBootstrap().setQuestionId(question);
  const auto words = capnp::messageToFlatArray(message);
  const auto bytes = words.asBytes();
  return {reinterpret_cast<const char*>(bytes.begin()), bytes.size()};
}

/// A client that speaks the protocol, but as it likes. Lives in an event loop of its own.
class Speaker {
 public:
  explicit Speaker(const std::filesystem::path& socket)
      : descriptor_(detail::connect_socket(socket, kLong).value()) {
    loop_.run([this](kj::AsyncIoContext& io) {
      stream_ = io.lowLevelProvider->wrapSocketFd(descriptor_.get());
      client_ = kj::heap<capnp::TwoPartyClient>(*stream_);
    });
  }
  ~Speaker() { vanish(); }

  /// The error of a hello, or an empty one.
  Error hello(std::uint32_t version) {
    auto done = std::make_shared<std::promise<Error>>();
    auto answer = done->get_future();
    loop_.run([&](kj::AsyncIoContext&) {
      auto request = client_->bootstrap().castAs<wire::Gate>().helloRequest();
      request.setVersion(version);
      request.setSoftware("99.0");
      request.setWants("robot");
      promise_ = request.send()
                     .then([this, done](auto&& response) {
                       if (response.hasService())
                         robot_ = response.getService().template castAs<wire::Robot>();
                       done->set_value(response.hasError() ? detail::decode(response.getError())
                                                           : fail(ErrorCode::Internal, ""));
                     })
                     .eagerlyEvaluate(nullptr);
    });
    return answer.get();
  }

  /// Begins a call that waits, and does not wait for it.
  void call_and_forget() {
    loop_.run([&](kj::AsyncIoContext&) {
      auto request = robot_.callRequest();
      request.setOperation("wait");
      request.setTimeout(Duration(kLong).count());
      call_ = request.send().ignoreResult().eagerlyEvaluate([](kj::Exception&&) {});
    });
  }

  /// As a killed process: the socket closes without a word.
  void vanish() {
    loop_.run([this](kj::AsyncIoContext&) {
      ::shutdown(descriptor_.get(), SHUT_RDWR);
      call_ = nullptr;
      promise_ = nullptr;
      robot_ = nullptr;
      client_ = nullptr;
      stream_ = nullptr;
    });
  }

 private:
  Descriptor descriptor_;
  kj::Own<kj::AsyncIoStream> stream_;
  kj::Own<capnp::TwoPartyClient> client_;
  wire::Robot::Client robot_ = nullptr;
  kj::Promise<void> promise_ = nullptr;
  kj::Promise<void> call_ = nullptr;
  detail::EventLoop loop_;  // goes first: the rest is empty by then
};

TEST_F(ControlTest, GarbageIsRefusedAndOthersAreNotDisturbed) {
  serve();
  const auto good = client();
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    Raw hostile(socket_);
    std::string bytes(4096, '\0');
    for (char& byte : bytes)
      byte = static_cast<char>(random() | 0x80U);
    hostile.send(bytes);
    EXPECT_TRUE(hostile.is_closed()) << round;
    EXPECT_TRUE(good->status());
  }
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
  std::string flood;
  for (std::uint32_t question = 0; question < 200'000; ++question)
    flood += bootstrap_message(question);
  // The server's queue and the two socket buffers fill up, then it reads no more.
  EXPECT_LT(hostile.send(flood, std::chrono::milliseconds(300)), flood.size() / 4);
  EXPECT_TRUE(good->status());
}

TEST_F(ControlTest, AnotherVersionIsToldBothVersions) {
  serve();
  Speaker other(socket_);
  const Error refused = other.hello(999);
  EXPECT_EQ(refused.code, ErrorCode::Unsupported);
  EXPECT_NE(refused.message.find("999"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("speaks version 2 "), std::string::npos) << refused.message;
  EXPECT_EQ(Speaker(socket_).hello(detail::kProtocolVersion).message, "");
}

TEST_F(ControlTest, AClientThatVanishesInACallLeavesTheServerWhole) {
  serve();
  Speaker doomed(socket_);
  ASSERT_EQ(doomed.hello(detail::kProtocolVersion).message, "");
  doomed.call_and_forget();
  ASSERT_TRUE(robot_.entered.wait());
  doomed.vanish();
  const auto good = client();
  EXPECT_TRUE(good->status());
  robot_.release.open();
  EXPECT_EQ(good->call("t", "wait", Value(), soon()).value(), Value("released"));
}

TEST_F(ControlTest, TheSixtyFifthClientIsToldWhyAndTheOthersGoOn) {
  serve();
  const auto good = client();
  std::vector<std::unique_ptr<Raw>> crowd;
  while (crowd.size() < 63)
    crowd.push_back(std::make_unique<Raw>(socket_));
  const auto refused = connect(socket_, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ResourceExhausted) << to_string(refused.error());
  while (crowd.size() < 200)
    crowd.push_back(std::make_unique<Raw>(socket_));
  EXPECT_TRUE(crowd.back()->is_closed());
  EXPECT_TRUE(good->status());
  crowd.clear();
  auto again = connect(socket_, kLong);
  for (const auto limit = soon(); !again && RealClock::instance().now() < limit;) {
    again = connect(socket_, kLong);
  }
  EXPECT_TRUE(again);
}

}  // namespace
}  // namespace segue::control
