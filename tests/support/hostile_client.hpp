// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/event_loop.hpp>
#include <segue/rpc/detail/socket.hpp>
#include <segue/rpc/detail/tcp_socket.hpp>
#include <segue/rpc/detail/wire.hpp>
#include <support/fake_robot_service.hpp>

#include <capnp/message.h>
#include <capnp/rpc-twoparty.h>
#include <capnp/rpc.capnp.h>
#include <capnp/serialize.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstring>
#include <functional>
#include <future>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Hostile clients, for tests only.
namespace segue::control {

/// A client that does not speak the protocol.
class Raw {
 public:
  explicit Raw(const std::filesystem::path& socket)
      : descriptor_(detail::connect_socket(socket, kLong).value()) {}
  /// Of a TCP server on this computer.
  explicit Raw(std::uint16_t port) : descriptor_(detail::connect_tcp({"127.0.0.1", port}, soon()).value()) {}

  /// The number of bytes that the server accepts before it closes or stops reading for `patience`.
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

  /// Sends one byte together with descriptors.
  void send_descriptors(const std::vector<int>& descriptors) {
    char byte = 0;
    iovec piece{&byte, 1};
    std::vector<char> control(CMSG_SPACE(sizeof(int) * descriptors.size()));
    msghdr message{};
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int) * descriptors.size());
    std::memcpy(CMSG_DATA(header), descriptors.data(), sizeof(int) * descriptors.size());
    EXPECT_EQ(::sendmsg(descriptor_.get(), &message, MSG_NOSIGNAL), 1);
  }

  /// Whether the server closes in time; discards its data until then.
  bool is_closed() {
    char buffer[4096];
    for (;;) {
      const auto got = ::recv(descriptor_.get(), buffer, sizeof buffer, 0);
      if (got == 0 || (got < 0 && errno != EAGAIN)) return true;
      if (got < 0 && !wait_for(POLLIN, kLong)) return false;
    }
  }

  /// Whether the server closes within that time; discards its data.
  bool closes_within(Duration limit) {
    char byte = 0;
    while (wait_for(POLLIN, limit)) {
      const auto got = ::recv(descriptor_.get(), &byte, 1, 0);
      if (got == 0 || (got < 0 && errno != EAGAIN)) return true;
    }
    return false;
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
inline std::string word(std::uint32_t low, std::uint32_t high) {
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &low, 4);
  std::memcpy(bytes.data() + 4, &high, 4);
  return bytes;
}

/// A request for the bootstrap capability, which the server answers.
inline std::string bootstrap_message(std::uint32_t question) {
  capnp::MallocMessageBuilder message;
  message.initRoot<capnp::rpc::Message>().initBootstrap().setQuestionId(question);
  const auto words = capnp::messageToFlatArray(message);
  const auto bytes = words.asBytes();
  return {reinterpret_cast<const char*>(bytes.begin()), bytes.size()};
}

/// That many requests: endless valid data.
inline std::string flood_of(std::uint32_t questions) {
  std::string flood;
  for (std::uint32_t question = 0; question < questions; ++question)
    flood += bootstrap_message(question);
  return flood;
}

/// Sends random bytes: such clients are rejected, and `others_are_well` holds after each.
inline void send_garbage(const std::filesystem::path& socket, const std::function<bool()>& others_are_well) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    Raw hostile(socket);
    std::string bytes(4096, '\0');
    for (char& byte : bytes)
      byte = static_cast<char>(random() | 0x80U);
    hostile.send(bytes);
    EXPECT_TRUE(hostile.is_closed()) << round;
    EXPECT_TRUE(others_are_well()) << round;
  }
}

/// A client that speaks the protocol but violates its rules. Has an event loop of its own.
class Speaker {
 public:
  explicit Speaker(const std::filesystem::path& socket)
      : descriptor_(detail::connect_socket(socket, kLong).value()) {
    loop_.run([this](kj::AsyncIoContext& io) {
      stream_ = io.lowLevelProvider->wrapUnixSocketFd(descriptor_.get());
      client_ = kj::heap<capnp::TwoPartyClient>(*stream_, 2U);
    });
  }
  ~Speaker() { vanish(); }

  /// The error of a greeting, or an empty one.
  Error hello(std::uint32_t version, const char* wants) {
    return ask([this, version, wants](capnp::Capability::Client) {
      auto request = client_->bootstrap().castAs<wire::Bootstrap>().helloRequest();
      request.setVersion(version);
      request.setSoftware("99.0");
      request.setWants(wants);
      return request.send().then([this](auto&& response) {
        if (response.hasService()) service_ = response.getService();
        return response.hasError() ? detail::decode(response.getError()) : Error{};
      });
    });
  }

  /// The result of `call` (a kj::Promise<Error>(service)); Unavailable if the connection breaks.
  Error ask(const std::function<kj::Promise<Error>(capnp::Capability::Client)>& call) {
    auto done = std::make_shared<std::promise<Error>>();
    auto answer = done->get_future();
    loop_.run([&](kj::AsyncIoContext&) {
      promise_ = call(service_)
                     .then([done](Error&& error) { done->set_value(std::move(error)); },
                           [done](kj::Exception&& exception) {
                             done->set_value(fail(ErrorCode::Unavailable, exception.getDescription().cStr()));
                           })
                     .eagerlyEvaluate(nullptr);
    });
    return answer.get();
  }

  /// Begins a call and does not wait for it.
  void begin(const std::function<kj::Promise<void>(capnp::Capability::Client)>& call) {
    loop_.run([&](kj::AsyncIoContext&) {
      calls_.push_back(call(service_).eagerlyEvaluate([](kj::Exception&&) {}));
    });
  }

  /// Closes the socket without a message, as a killed process does.
  void vanish() {
    loop_.run([this](kj::AsyncIoContext&) {
      ::shutdown(descriptor_.get(), SHUT_RDWR);
      calls_.clear();
      promise_ = nullptr;
      service_ = nullptr;
      client_ = nullptr;
      stream_ = nullptr;
    });
  }

 private:
  Descriptor descriptor_;
  kj::Own<kj::AsyncCapabilityStream> stream_;
  kj::Own<capnp::TwoPartyClient> client_;
  capnp::Capability::Client service_ = nullptr;
  kj::Promise<void> promise_ = nullptr;
  std::vector<kj::Promise<void>> calls_;
  detail::EventLoop loop_;  // goes first: the rest is empty by then
};

}  // namespace segue::control
