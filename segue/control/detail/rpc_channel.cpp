// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/rpc_channel.hpp>
#include <segue/control/detail/socket.hpp>

#include <kj/debug.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

constexpr Duration kMaxTimeout = std::chrono::hours(24 * 30);

capnp::ReaderOptions reader_options() {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = kClientMessageWords;
  options.nestingLimit = kMessageNesting;
  return options;
}

kj::Exception not_connected() {
  return KJ_EXCEPTION(DISCONNECTED, "not connected");
}

kj::Duration to_kj(Duration duration) {
  return std::clamp(duration, Duration(0), kMaxTimeout).count() * kj::NANOSECONDS;
}

wire::Gate::Client gate_of(capnp::RpcSystem<capnp::rpc::twoparty::VatId>& rpc) {
  capnp::MallocMessageBuilder message(8);
  auto id = message.initRoot<capnp::rpc::twoparty::VatId>();
  id.setSide(capnp::rpc::twoparty::Side::SERVER);
  return rpc.bootstrap(id).castAs<wire::Gate>();
}

/// An offer of memory has two descriptors; no other message has any.
constexpr unsigned kMaxDescriptors = 2;

}  // namespace

Duration time_left(TimePoint deadline) {
  const TimePoint now = RealClock::instance().now();
  return deadline > now ? deadline - now : Duration(0);
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

RpcChannel::Connection::Connection(kj::AsyncIoContext& io, int descriptor, unsigned descriptors)
    : stream_(io.lowLevelProvider->wrapUnixSocketFd(descriptor,
                                                    kj::LowLevelAsyncIoProvider::TAKE_OWNERSHIP |
                                                        kj::LowLevelAsyncIoProvider::ALREADY_CLOEXEC |
                                                        kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK)),
      network_(*stream_, descriptors, capnp::rpc::twoparty::Side::CLIENT, reader_options()),
      rpc_(capnp::makeRpcClient(network_)),
      service_(kj::Exception(not_connected())) {}

capnp::Capability::Client RpcChannel::Connection::held_capability(StreamId id) {
  const auto found = held_.find(id);
  if (found == held_.end()) return not_connected();
  return found->second;
}

RpcChannel::Answer RpcChannel::Connection::hello(std::string_view kind) {
  auto request = gate_of(rpc_).helloRequest();
  request.setVersion(kProtocolVersion);
  request.setSoftware(SEGUE_VERSION);
  request.setWants(as_text(std::string(kind)));
  auto sent = request.send();
  service_ = sent.getService();
  return sent.then([this](auto&& response) -> Result<Value> {
    if (const auto version = response.getVersion(); version != kProtocolVersion) {
      return fail(ErrorCode::InvalidState, "segue " + as_string(response.getSoftware()) +
                                               " answers, which speaks version " + std::to_string(version) +
                                               " of the control protocol; this is segue " SEGUE_VERSION
                                               ", which speaks version " +
                                               std::to_string(kProtocolVersion) +
                                               "; use programs of one version, or start that one anew");
    }
    if (response.hasError()) return decode(response.getError());
    service_ = response.getService();
    return Value(as_string(response.getSoftware()));
  });
}

void RpcChannel::Connection::watch(std::function<void()> gone) {
  watch_ = nullptr;
  if (gone) watch_ = network_.onDisconnect().then(std::move(gone)).eagerlyEvaluate(nullptr);
}

RpcChannel::RpcChannel(std::string who) : who_(std::move(who)) {}

RpcChannel::~RpcChannel() {
  loop_.run([this](kj::AsyncIoContext&) {
    calls_.reset();
    failures_.reset();
    connection_.reset();
  });
}

Result<std::shared_ptr<RpcChannel>> RpcChannel::open(const std::filesystem::path& socket,
                                                     std::string_view kind, std::string who, Duration timeout,
                                                     const Begin& first) {
  const TimePoint deadline = RealClock::instance().now() + timeout;
  auto connected = connect_socket(socket, timeout);
  if (!connected) return connected.error();
  try {
    const std::shared_ptr<RpcChannel> channel(new RpcChannel(std::move(who)));
    channel->loop_.run([&](kj::AsyncIoContext& io) {
      channel->failures_ = std::make_unique<Failures>();
      channel->calls_ = std::make_unique<kj::TaskSet>(*channel->failures_);
      channel->connection_ = std::make_unique<Connection>(io, connected->release(),
                                                          kind == kDeploymentKind ? kMaxDescriptors : 0);
    });
    const auto greeted = channel->ask(time_left(deadline), [&](Connection& connection) -> Answer {
      auto hello = connection.hello(kind);
      if (!first) return hello;
      return hello.then([more = first(connection)](Result<Value>&& answer) mutable -> Answer {
        if (!answer) return kj::mv(answer);
        return more.then([answer = std::move(answer)]() mutable { return std::move(answer); });
      });
    });
    if (!greeted) return greeted.error();
    return channel;
  } catch (const std::exception& exception) {
    return fail(ErrorCode::ResourceExhausted, std::string("cannot connect: ") + exception.what());
  }
}

bool RpcChannel::start(Duration timeout, Begin begin, Failed failed) {
  return loop_.post(
      [this, begin = std::move(begin), failed = std::move(failed), timeout](kj::AsyncIoContext&) {
        auto late = loop_.timer().afterDelay(to_kj(timeout)).then([] { return false; });
        auto call = kj::evalNow([&]() -> kj::Promise<void> {
                      try {
                        return begin(*connection_);
                      } catch (const WireError& error) {
                        failed(error.error());
                        return kj::READY_NOW;
                      }
                    })
                        .then([] { return true; })
                        .exclusiveJoin(kj::mv(late))
                        .then(
                            [this, failed, timeout](bool in_time) {
                              if (in_time) return;
                              failed(fail(ErrorCode::DeadlineExceeded,
                                          who_ + " did not answer within " + format_duration(timeout)));
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
