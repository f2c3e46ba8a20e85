// SPDX-License-Identifier: Apache-2.0
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc/detail/socket.hpp>
#include <segue/rpc/detail/tcp_socket.hpp>

#include <kj/debug.h>
#include <kj/io.h>

#include <exception>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

constexpr unsigned kReadySocket =
    kj::LowLevelAsyncIoProvider::ALREADY_CLOEXEC | kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK;

}  // namespace

Duration time_left(TimePoint deadline) {
  const TimePoint now = RealClock::instance().now();
  return deadline > now ? deadline - now : Duration(0);
}

std::string name_of(const Endpoint& endpoint) {
  if (const auto* tcp = std::get_if<TcpEndpoint>(&endpoint)) return tcp->host;
  return std::get<std::filesystem::path>(endpoint).stem().string();
}

Result<void> check_request(std::uint64_t words) {
  // Half, since the reader of a message counts some parts twice.
  if (words <= kServerMessageWords / 2) return {};
  return fail(ErrorCode::ResourceExhausted,
              "a message of " + std::to_string(words * 8 >> 20) + " MiB is too large to be sent; at most " +
                  std::to_string(kServerMessageWords * 8 / 2 >> 20) + " MiB are");
}

struct RpcChannel::Failures final : kj::TaskSet::ErrorHandler {
  /// start() handles all failures itself.
  void taskFailed(kj::Exception&&) override {}
};

RpcChannel::RpcChannel(std::string who) : who_(std::move(who)) {}

RpcChannel::~RpcChannel() {
  loop_.run([this](kj::AsyncIoContext&) {
    calls_.reset();
    failures_.reset();
    connection_.reset();
  });
}

Result<std::shared_ptr<RpcChannel>> RpcChannel::open(const Endpoint& endpoint, const ServiceKind& kind,
                                                     std::string who, Duration timeout, const Begin& first,
                                                     const std::stop_token& stop) {
  const Limit limit{timeout, RealClock::instance().now() + timeout};
  const auto* path = std::get_if<std::filesystem::path>(&endpoint);
  const auto* tcp = std::get_if<TcpEndpoint>(&endpoint);
  auto connected = path != nullptr ? connect_socket(*path, {limit.deadline, stop})
                                   : connect_tcp(tcp->address, limit.deadline);
  if (!connected) return connected.error();
  try {
    std::shared_ptr<RpcChannel> channel(new RpcChannel(std::move(who)));
    const auto used = path != nullptr ? channel->use(std::move(*connected), kind.descriptors)
                                      : channel->use(std::move(*connected), *tcp, limit);
    if (!used) return used.error();
    if (auto greeted = channel->greet(kind.name, limit, first, stop); !greeted) return greeted.error();
    return channel;
  } catch (const std::exception& exception) {
    return fail(ErrorCode::ResourceExhausted, std::string("cannot connect: ") + exception.what());
  }
}

Result<void> RpcChannel::use(Descriptor socket, unsigned descriptors) {
  loop_.run([&](kj::AsyncIoContext& io) {
    failures_ = std::make_unique<Failures>();
    calls_ = std::make_unique<kj::TaskSet>(*failures_);
    auto stream = io.lowLevelProvider->wrapUnixSocketFd(kj::AutoCloseFd(socket.release()), kReadySocket);
    connection_ = std::make_unique<Connection>(kj::mv(stream), nullptr, descriptors);
  });
  return {};
}

Result<void> RpcChannel::use(Descriptor socket, const TcpEndpoint& endpoint, const Limit& limit) {
  auto done = std::make_shared<std::promise<Result<void>>>();
  auto outcome = done->get_future();
  loop_.run([&](kj::AsyncIoContext& io) {
    failures_ = std::make_unique<Failures>();
    calls_ = std::make_unique<kj::TaskSet>(*failures_);
    auto stream = io.lowLevelProvider->wrapSocketFd(kj::AutoCloseFd(socket.release()), kReadySocket);
    shake_hands(endpoint.credentials.encryption().connect(kj::mv(stream), endpoint.host),
                endpoint.credentials, limit, done);
  });
  done.reset();  // so that it is broken where the loop has failed
  return outcome.get();
}

void RpcChannel::shake_hands(kj::Own<SecureStream> stream, const Credentials& credentials, const Limit& limit,
                             const std::shared_ptr<std::promise<Result<void>>>& done) {
  auto late = loop_.timer().afterDelay(to_kj(time_left(limit.deadline))).then([this, timeout = limit.whole] {
    Error silent = silence(timeout);
    silent.message += " in the TLS handshake";
    return Result<Identity>(std::move(silent));
  });
  auto handshake = stream->handshake();
  calls_->add(
      handshake.exclusiveJoin(kj::mv(late))
          .then([this, done, ours = credentials, stream = kj::mv(stream)](Result<Identity>&& shown) mutable {
            if (!shown) return done->set_value(shown.error());
            SecureStream* secure = stream.get();
            connection_ = std::make_unique<Connection>(kj::mv(stream), secure, 0);
            calls_->add(connection_->guard(loop_.timer(), std::move(ours), std::move(*shown)));
            done->set_value(Result<void>());
          }));
}

Result<void> RpcChannel::greet(std::string_view kind, const Limit& limit, const Begin& first,
                               const std::stop_token& stop) {
  const auto begin = [&](Connection& connection) -> Answer {
    auto hello = connection.hello(kind);
    if (!first) return hello;
    return hello.then([more = first(connection)](Result<Value>&& answer) mutable -> Answer {
      if (!answer) return kj::mv(answer);
      return more.then([answer = std::move(answer)]() mutable { return std::move(answer); });
    });
  };
  const auto greeted = ask(time_left(limit.deadline), begin, stop);
  if (greeted) return {};
  // Connecting has taken a part of the time, so the message names the whole.
  return greeted.error().code == ErrorCode::DeadlineExceeded ? silence(limit.whole) : greeted.error();
}

Error RpcChannel::silence(Duration timeout) const {
  return fail(ErrorCode::DeadlineExceeded, who_ + " did not answer within " + format_seconds(timeout));
}

kj::Promise<RpcChannel::End> RpcChannel::stopped(const std::stop_token& stop) {
  if (!stop.stop_possible()) return kj::NEVER_DONE;
  auto pair = kj::newPromiseAndFulfiller<End>();
  // Shared because what is posted must be copyable; the last of both is destroyed in the loop's thread.
  auto fulfiller = std::make_shared<kj::Own<kj::PromiseFulfiller<End>>>(kj::mv(pair.fulfiller));
  const auto tell = [this, fulfiller] {
    loop_.post([fulfiller](kj::AsyncIoContext&) { (*fulfiller)->fulfill(End::Stop); });
  };
  return pair.promise.attach(kj::heap<std::stop_callback<std::function<void()>>>(stop, tell));
}

bool RpcChannel::start(Duration timeout, Begin begin, Failed failed, std::stop_token stop) {
  return loop_.post([this, begin = std::move(begin), failed = std::move(failed), timeout,
                     stop = std::move(stop)](kj::AsyncIoContext&) {
    if (stop.stop_requested()) return failed(no_longer_wanted());
    auto late = loop_.timer().afterDelay(to_kj(timeout)).then([] { return End::Timeout; });
    auto call = kj::evalNow([&]() -> kj::Promise<void> {
                  try {
                    return begin(*connection_);
                  } catch (const WireError& error) {
                    failed(error.error());
                    return kj::READY_NOW;
                  }
                })
                    .then([] { return End::Answer; })
                    .exclusiveJoin(kj::mv(late))
                    .exclusiveJoin(stopped(stop))
                    .then(
                        [this, failed, timeout](End end) {
                          if (end == End::Answer) return;
                          if (end == End::Stop) return failed(no_longer_wanted());
                          failed(silence(timeout));
                        },
                        [this, failed](kj::Exception&& exception) { failed(translate(exception)); });
    calls_->add(kj::mv(call));
  });
}

void RpcChannel::run(const std::function<void()>& work) {
  loop_.run([&](kj::AsyncIoContext&) { work(); });
}

void RpcChannel::watch(std::function<void()> gone) {
  loop_.run([&](kj::AsyncIoContext&) { connection_->watch(std::move(gone)); });
}

void RpcChannel::unwatch() {
  loop_.run([&](kj::AsyncIoContext&) { connection_->watch(nullptr); });
}

void RpcChannel::close_stream(StreamId id) {
  loop_.post([this, id](kj::AsyncIoContext&) {
    if (connection_) connection_->close(id);
  });
}

Error RpcChannel::translate(const kj::Exception& exception) const {
  if (connection_ != nullptr) {
    if (auto problem = connection_->problem()) return *problem;
  }
  switch (exception.getType()) {
    case kj::Exception::Type::DISCONNECTED:
      return fail(ErrorCode::Unavailable, who_ + " is gone");
    case kj::Exception::Type::OVERLOADED:
      return fail(ErrorCode::ResourceExhausted, who_ + " is overloaded; try again");
    case kj::Exception::Type::UNIMPLEMENTED:
      return fail(ErrorCode::Unsupported, who_ + " runs a segue that cannot do this");
    case kj::Exception::Type::FAILED:
      break;
  }
  return fail(ErrorCode::Internal,
              who_ + " could not answer: " + std::string(exception.getDescription().cStr()));
}

}  // namespace segue::control::detail
