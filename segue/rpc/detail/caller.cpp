// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/detail/caller.hpp>

#include <algorithm>
#include <exception>
#include <string>

namespace segue::control::detail {

namespace {

/// Batches wait for hooks of tasks, on a host for those of many tasks at once.
constexpr std::size_t kMaxBatchesPerClient = 256;
constexpr std::size_t kMaxWatchesPerClient = 256;
constexpr Duration kMaxTimeout = std::chrono::hours(24);

Error refused(ErrorCode code, std::string_view noun, std::string_view why) {
  return fail(code, std::string(noun) + std::string(why));
}

}  // namespace

Duration timeout_of(std::int64_t timeout) {
  return std::clamp(Duration(timeout), Duration(0), kMaxTimeout);
}

TimePoint deadline_after(std::int64_t timeout) {
  return RealClock::instance().now() + timeout_of(timeout);
}

Error thrown_by_service(std::string_view noun) {
  try {
    throw;
  } catch (const std::exception& exception) {
    return fail(ErrorCode::Internal, std::string(noun) + " failed: " + exception.what());
  } catch (...) {
    return fail(ErrorCode::Internal, std::string(noun) + " failed");
  }
}

Result<void> Caller::require(Role needed) const {
  const Peer& peer = client_->peer;
  if (peer.role >= needed) return {};
  const std::string has(to_string(peer.role));
  const std::string needs(to_string(needed));
  core_.refusals.tell(to_string(peer),
                      "what it asked of " + std::string(core_.noun()) + " needs the role " + needs);
  return fail(ErrorCode::PermissionDenied, quote(peer.name) + " may only " + has + " " +
                                               std::string(core_.noun()) + "; this needs the role " + needs +
                                               ", with which an administrator can enrol " + quote(peer.name) +
                                               " anew");
}

Result<void> Caller::begin() {
  if (core_.stopping) {
    return refused(ErrorCode::Unavailable, core_.noun(), " is shutting down");
  }
  return core_.calls.begin(*client_, lane_);
}

Result<void> Caller::begin_batch() {
  if (core_.stopping) {
    return refused(ErrorCode::Unavailable, core_.noun(), " is shutting down");
  }
  if (client_->batches >= kMaxBatchesPerClient) {
    return fail(ErrorCode::ResourceExhausted,
                "this client has too many batches of actions in progress; wait for one to end");
  }
  ++client_->batches;
  return {};
}

Result<void> Caller::begin_watch() {
  if (core_.stopping) {
    return refused(ErrorCode::Unavailable, core_.noun(), " is shutting down");
  }
  if (client_->watches >= kMaxWatchesPerClient) {
    return fail(ErrorCode::ResourceExhausted, "this client watches too much at once");
  }
  ++client_->watches;
  return {};
}

kj::Promise<Result<void>> Caller::run(Role needed, std::function<void()> job) {
  using Fulfiller = kj::Own<kj::PromiseFulfiller<Result<void>>>;
  if (auto permitted = require(needed); !permitted) return permitted;
  if (auto begun = begin(); !begun) {
    return begun;
  }
  auto pair = kj::newPromiseAndFulfiller<Result<void>>();
  // Shared because std::function must be copyable; it is only moved, and destroyed in the loop's thread.
  auto fulfiller = std::make_shared<Fulfiller>(kj::mv(pair.fulfiller));
  const bool begun = core_.pool_of(lane_).try_submit([caller = *this, job = std::move(job),
                                                      fulfiller]() mutable {
    job();
    job = nullptr;
    EventLoop& loop = caller.core_.loop;
    loop.post([caller = std::move(caller), fulfiller = std::move(fulfiller)](kj::AsyncIoContext&) mutable {
      caller.end();
      (*fulfiller)->fulfill(Result<void>());
    });
  });
  if (!begun) {
    end();
    return Result<void>(
        refused(ErrorCode::ResourceExhausted, core_.noun(), " has too many calls in progress; try again"));
  }
  return kj::mv(pair.promise);
}

}  // namespace segue::control::detail
