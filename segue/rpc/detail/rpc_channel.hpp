// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/rpc/detail/encryption.hpp>
#include <segue/rpc/detail/event_loop.hpp>
#include <segue/rpc/detail/offered_service.hpp>
#include <segue/rpc/detail/rpc_connection.hpp>
#include <segue/rpc/detail/wire.hpp>
#include <segue/rpc/endpoint.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

namespace segue::control::detail {

/// The timeout of calls that only read; a service answers them within milliseconds.
inline constexpr Duration kQueryTimeout = std::chrono::seconds(10);
/// A service reports a passed deadline itself, with more detail. Only where it does not within this time, the
/// client does.
inline constexpr Duration kGrace = std::chrono::seconds(2);

/// The time until `deadline`; 0 where it has passed.
Duration time_left(TimePoint deadline);
/// How long a call that only reads waits for its answer.
inline Duration query_timeout(const Wait& wait) {
  return std::min(time_left(wait.deadline), kQueryTimeout);
}
/// For messages: the socket's name without its ending, or the host's.
std::string name_of(const Endpoint& endpoint);
/// ResourceExhausted where a request of so many words is more than a server takes.
Result<void> check_request(std::uint64_t words);

/// A client's connection to a service, with an event loop of its own; calls block until their answer or their
/// timeout. Thread safe.
class RpcChannel {
 public:
  using StreamId = RpcConnection::StreamId;
  template <class T>
  using Reply = kj::Promise<Result<T>>;
  using Answer = RpcConnection::Answer;
  using Connection = RpcConnection;

  using Begin = std::function<kj::Promise<void>(Connection&)>;
  using Failed = std::function<void(Error)>;

  /// Connects and calls hello(). `who` is the name of the other side in messages: "robot 'spot'". `first` is
  /// called in the loop; its requests to the service travel with hello(), so that all of them take one round
  /// trip; its promise is waited for unless hello() is refused. `timeout` is for all of it: name, connection,
  /// TLS and hello. Cancelled once a stop is requested, but for the first three on TCP.
  static Result<std::shared_ptr<RpcChannel>> open(const Endpoint& endpoint, const ServiceKind& kind,
                                                  std::string who, Duration timeout, const Begin& first = {},
                                                  const std::stop_token& stop = {});
  ~RpcChannel();
  RpcChannel(const RpcChannel&) = delete;
  RpcChannel& operator=(const RpcChannel&) = delete;

  /// Calls `build`, which returns a Reply<T>, in the loop and waits for its answer. `build` may refer to the
  /// caller's variables. Cancelled once a stop is requested: the other side learns that the call was dropped,
  /// if it was sent. Must not be called from the loop's own thread.
  template <class T = type::Value, class Build>
  Result<T> ask(Duration timeout, const Build& build, const std::stop_token& stop = {});

  /// Calls `begin` in the loop and returns at once. Where its promise fails, or is not resolved in time or
  /// before a stop, calls `failed` there. False after the loop's end. Calls neither once this is destroyed.
  bool start(Duration timeout, Begin begin, Failed failed, std::stop_token stop = {});

  /// Runs `work` in the loop and waits for its end. Must not be called from the loop's own thread.
  void run(const std::function<void()>& work);

  /// Sends a request whose results are an `answer`.
  template <class Request>
  static Answer send(Request& request);
  /// Sends a request whose results have an `error`; where that is none, the reply is `read(results)`.
  template <class T, class Request, class Read>
  static Reply<T> send(Request& request, Read read);

  /// Calls `gone` once, from the loop's thread, when the connection breaks; at once where it is broken
  /// already. `gone` must not wait for a thread that calls unwatch() or destroys this.
  void watch(std::function<void()> gone);
  /// `gone` is not called any more when this returns.
  void unwatch();

  StreamId new_stream_id() { return next_stream_++; }
  void close_stream(StreamId id);
  [[nodiscard]] const std::string& who() const { return who_; }

 private:
  explicit RpcChannel(std::string who);
  Result<void> use(Descriptor socket, unsigned descriptors);
  /// The time for all of a connection, and until when that lasts.
  struct Limit {
    Duration whole{};
    TimePoint deadline{};
  };
  Result<void> use(Descriptor socket, const TcpEndpoint& endpoint, const Limit& limit);
  void shake_hands(kj::Own<SecureStream> stream, const Credentials& credentials, const Limit& limit,
                   const std::shared_ptr<std::promise<Result<void>>>& done);
  Result<void> greet(std::string_view kind, const Limit& limit, const Begin& first,
                     const std::stop_token& stop);
  [[nodiscard]] Error silence(Duration timeout) const;
  [[nodiscard]] Error translate(const kj::Exception& exception) const;

  enum class End : std::uint8_t { Answer, Timeout, Stop };  ///< what ends a call
  kj::Promise<End> stopped(const std::stop_token& stop);    ///< in the loop
  struct Failures;
  const std::string who_;
  std::atomic<StreamId> next_stream_{1};  ///< numbers differ, and order nothing
  EventLoop loop_;
  std::unique_ptr<Connection> connection_;  ///< used in the loop's thread only
  std::unique_ptr<Failures> failures_;      ///< used in the loop's thread only
  std::unique_ptr<kj::TaskSet> calls_;      ///< used in the loop's thread only
};

template <class T, class Build>
Result<T> RpcChannel::ask(Duration timeout, const Build& build, const std::stop_token& stop) {
  // Shared, since the waiting thread may return before set_value() does.
  const auto done = std::make_shared<std::promise<Result<T>>>();
  auto answer = done->get_future();
  const bool begun = start(
      timeout,
      [done, &build](Connection& connection) {
        return build(connection).then([done](Result<T>&& outcome) { done->set_value(std::move(outcome)); });
      },
      [done](Error error) { done->set_value(std::move(error)); }, stop);
  if (!begun) return fail(ErrorCode::Unavailable, "the connection is closed");
  return answer.get();
}

template <class Request>
RpcChannel::Answer RpcChannel::send(Request& request) {
  if (auto fits = check_request(request.totalSize().wordCount); !fits) {
    return Result<type::Value>(fits.error());
  }
  return request.send().then([](auto&& response) -> Result<type::Value> {
    return decode(response.getAnswer(), RpcConnection::kMaxNodes);
  });
}

template <class T, class Request, class Read>
RpcChannel::Reply<T> RpcChannel::send(Request& request, Read read) {
  if (auto fits = check_request(request.totalSize().wordCount); !fits) return Result<T>(fits.error());
  return request.send().then([read](auto&& response) -> Result<T> {
    if (response.hasError()) return decode(response.getError());
    return read(response);
  });
}

}  // namespace segue::control::detail
