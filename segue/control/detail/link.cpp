// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/link.hpp>
#include <segue/control/detail/socket.hpp>

#include <kj/debug.h>

#include <algorithm>
#include <exception>
#include <future>
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

}  // namespace

struct Link::Failures final : kj::TaskSet::ErrorHandler {
  /// ask() handles all failures itself.
  void taskFailed(kj::Exception&&) override {}
};

Link::Connection::Connection(kj::AsyncIoContext& io, int descriptor)
    : stream_(
          io.lowLevelProvider->wrapSocketFd(descriptor, kj::LowLevelAsyncIoProvider::TAKE_OWNERSHIP |
                                                            kj::LowLevelAsyncIoProvider::ALREADY_CLOEXEC |
                                                            kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK)),
      network_(*stream_, capnp::rpc::twoparty::Side::CLIENT, reader_options()),
      rpc_(capnp::makeRpcClient(network_)),
      robot_(kj::Exception(not_connected())) {}

wire::SampleStream::Client Link::Connection::stream(StreamId id) {
  const auto found = streams_.find(id);
  if (found == streams_.end()) return not_connected();
  return found->second;
}

Link::Answer Link::Connection::hello() {
  auto request = gate_of(rpc_).helloRequest();
  request.setVersion(kProtocolVersion);
  request.setSoftware(SEGUE_VERSION);
  return request.send().then([this](auto&& response) -> Result<Value> {
    if (response.hasError()) return decode(response.getError());
    robot_ = response.getRobot();
    return Value(as_string(response.getSoftware()));
  });
}

Link::Link(std::string name) : name_(std::move(name)) {}

Link::~Link() {
  loop_.run([this](kj::AsyncIoContext&) {
    calls_.reset();
    failures_.reset();
    connection_.reset();
  });
}

Result<std::shared_ptr<Link>> Link::open(const std::filesystem::path& socket, Duration timeout) {
  auto connected = connect_socket(socket, timeout);
  if (!connected) return connected.error();
  try {
    const std::shared_ptr<Link> link(new Link(socket.stem().string()));
    link->loop_.run([&](kj::AsyncIoContext& io) {
      link->failures_ = std::make_unique<Failures>();
      link->calls_ = std::make_unique<kj::TaskSet>(*link->failures_);
      link->connection_ = std::make_unique<Connection>(io, connected->release());
    });
    const auto greeted = link->ask(timeout, [](Connection& connection) { return connection.hello(); });
    if (!greeted) return greeted.error();
    return link;
  } catch (const std::exception& exception) {
    return fail(ErrorCode::ResourceExhausted, std::string("cannot connect: ") + exception.what());
  }
}

Result<Value> Link::ask(Duration timeout, const std::function<Answer(Connection&)>& build) {
  // Shared, since the waiter may be gone before set_value() returns.
  const auto done = std::make_shared<std::promise<Result<Value>>>();
  auto answer = done->get_future();
  const bool posted = loop_.post([this, done, &build, timeout](kj::AsyncIoContext& io) {
    auto late = io.provider->getTimer().afterDelay(to_kj(timeout)).then([this, timeout] {
      return Result<Value>(
          fail(ErrorCode::DeadlineExceeded,
               "robot " + quote(name_) + " did not answer within " + format_duration(timeout)));
    });
    auto call = kj::evalNow([&] { return build(*connection_); })
                    .exclusiveJoin(kj::mv(late))
                    .then([done](Result<Value>&& outcome) { done->set_value(std::move(outcome)); },
                          [this, done](kj::Exception&& exception) { done->set_value(translate(exception)); });
    calls_->add(kj::mv(call));
  });
  if (!posted) return fail(ErrorCode::Unavailable, "the connection is closed");
  return answer.get();
}

void Link::close_stream(StreamId id) {
  loop_.post([this, id](kj::AsyncIoContext&) {
    if (connection_) connection_->close(id);
  });
}

Error Link::translate(const kj::Exception& exception) const {
  switch (exception.getType()) {
    case kj::Exception::Type::DISCONNECTED:
      return fail(ErrorCode::Unavailable, "robot " + quote(name_) + " is gone");
    case kj::Exception::Type::OVERLOADED:
      return fail(ErrorCode::ResourceExhausted, "robot " + quote(name_) + " is overloaded; try again");
    case kj::Exception::Type::UNIMPLEMENTED:
      return fail(ErrorCode::Unsupported, "robot " + quote(name_) + " runs a segue that cannot do this");
    case kj::Exception::Type::FAILED:
      break;
  }
  return fail(ErrorCode::Internal, "robot " + quote(name_) + " could not answer: " +
                                       std::string(exception.getDescription().cStr()));
}

}  // namespace segue::control::detail
