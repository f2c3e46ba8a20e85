// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot.capnp.h>
#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/control/detail/event_loop.hpp>
#include <segue/control/detail/wire.hpp>

#include <capnp/rpc-twoparty.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>

namespace segue::control::detail {

/// A client's connection: an event loop of its own, and calls into it that block until their answer or their
/// timeout. Thread safe.
class Link {
 public:
  using StreamId = std::uint64_t;
  using Answer = kj::Promise<Result<type::Value>>;
  /// A client takes answers up to this many nodes.
  static constexpr std::uint64_t kMaxNodes = kClientMessageWords;

  /// What lives in the loop's thread.
  class Connection {
   public:
    Connection(kj::AsyncIoContext& io, int descriptor);

    [[nodiscard]] wire::Robot::Client& robot() { return robot_; }
    /// One that is not known answers every call with an exception.
    wire::SampleStream::Client stream(StreamId id);
    template <class Request>
    Answer open(StreamId id, Request& request);
    void close(StreamId id) { streams_.erase(id); }
    /// Exchanges versions; afterwards robot() works. The value is the robot's software.
    Answer hello();

   private:
    kj::Own<kj::AsyncIoStream> stream_;
    capnp::TwoPartyVatNetwork network_;
    capnp::RpcSystem<capnp::rpc::twoparty::VatId> rpc_;
    wire::Robot::Client robot_;
    std::map<StreamId, wire::SampleStream::Client> streams_;
  };

  /// Connects and says hello.
  static Result<std::shared_ptr<Link>> open(const std::filesystem::path& socket, Duration timeout);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Runs `build` in the loop and waits for its answer. What it refers to stays alive until then.
  Result<type::Value> ask(Duration timeout, const std::function<Answer(Connection&)>& build);
  template <class Request>
  static Answer send(Request& request);

  StreamId new_stream_id() { return next_stream_++; }
  void close_stream(StreamId id);

 private:
  explicit Link(std::string name);
  [[nodiscard]] Error translate(const kj::Exception& exception) const;

  struct Failures;
  const std::string name_;
  std::atomic<StreamId> next_stream_{1};
  EventLoop loop_;
  std::unique_ptr<Connection> connection_;  ///< used in the loop's thread only
  std::unique_ptr<Failures> failures_;      ///< likewise
  std::unique_ptr<kj::TaskSet> calls_;      ///< likewise
};

template <class Request>
Link::Answer Link::send(Request& request) {
  return request.send().then(
      [](auto&& response) -> Result<type::Value> { return decode(response.getAnswer(), kMaxNodes); });
}

template <class Request>
Link::Answer Link::Connection::open(StreamId id, Request& request) {
  return request.send().then([this, id](auto&& response) -> Result<type::Value> {
    auto type = decode(response.getAnswer(), kMaxNodes);
    if (type) streams_.emplace(id, response.getStream());
    return type;
  });
}

}  // namespace segue::control::detail
