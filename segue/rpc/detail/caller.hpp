// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/detail/server_core.hpp>
#include <segue/rpc/detail/wire.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>
#include <type_traits>
#include <utility>

/// Turns calls of clients into calls of a service, on the threads of a pool and under limits. All of this is
/// used in the server's event loop, except for the jobs.
namespace segue::control::detail {

/// A timeout that a client has sent, in nanoseconds, within reason.
Duration timeout_of(std::int64_t timeout);
/// When a call with this timeout, in nanoseconds, must be answered.
TimePoint deadline_after(std::int64_t timeout);

/// Runs service calls of one client. Only for use in the event loop.
class Caller {
 public:
  Caller(ServerCore& core, std::shared_ptr<ClientState> client, CallLane lane = CallLane::Ordinary)
      : core_(core), client_(std::move(client)), lane_(lane) {}
  /// A caller of the same client, for calls that nothing else may keep waiting.
  [[nodiscard]] Caller urgent() const { return {core_, client_, CallLane::Urgent}; }

  /// PermissionDenied, which is logged too, unless the client's role includes `needed`.
  Result<void> require(Role needed) const;

  /// Runs `job` on a thread of the pool and resolves when it has ended; PermissionDenied, ResourceExhausted
  /// or Unavailable, at once, where it is not begun. `job` must not throw.
  kj::Promise<Result<void>> run(Role needed, std::function<void()> job);

  /// For a call that takes none of the pool's threads: it counts as one in progress until end(). Unavailable
  /// or ResourceExhausted where it may not be begun.
  Result<void> begin();
  void end() { core_.calls.end(*client_, lane_); }
  /// For a batch of actions: it counts as one in progress until end_batch(); more of these may be in progress
  /// than of other calls. Unavailable or ResourceExhausted where it may not be begun.
  Result<void> begin_batch();
  void end_batch() { --client_->batches; }
  /// For a question that is answered later: it counts as one until it is answered. Unavailable or
  /// ResourceExhausted where it may not be begun.
  Result<void> begin_watch();

  /// Runs `job`, which returns a Result<T> and may take a std::stop_token, by which it learns that the client
  /// has dropped the call, then `reply(T&, results)` (for T void: `reply(results)`). Errors,
  /// exceptions of the job included, become the `error` of the results; so does a role that does not include
  /// `needed` (Observe, which everybody has, where none is named). Parameters must have been read.
  template <class Context, class Job, class Reply>
  kj::Promise<void> answer(Role needed, Context context, Job job, Reply reply);
  template <class Context, class Job, class Reply>
  kj::Promise<void> answer(Context context, Job job, Reply reply) {
    return answer(Role::Observe, context, std::move(job), std::move(reply));
  }
  /// Runs `job` like answer(), but in the loop itself, for a job that only reads data at hand.
  template <class Context, class Job, class Reply>
  kj::Promise<void> answer_here(Context context, Job job, Reply reply);
  /// Answers with a `job` that returns a Result<void> and has no results to add.
  template <class Context, class Job>
  kj::Promise<void> answer(Context context, Job job) {
    return answer(context, std::move(job), [](auto) {});
  }
  /// Answers with a `job` that returns a Result<Value>, which becomes the `answer` of the results; calls
  /// `done(results)` unless it is an error.
  template <class Context, class Job, class Done>
  kj::Promise<void> answer_value(Role needed, Context context, Job job, Done done);
  template <class Context, class Job, class Done>
  kj::Promise<void> answer_value(Context context, Job job, Done done) {
    return answer_value(Role::Observe, context, std::move(job), std::move(done));
  }
  template <class Context, class Job>
  kj::Promise<void> answer_value(Role needed, Context context, Job job) {
    return answer_value(needed, context, std::move(job), [](auto) {});
  }
  template <class Context, class Job>
  kj::Promise<void> answer_value(Context context, Job job) {
    return answer_value(Role::Observe, context, std::move(job));
  }

  [[nodiscard]] ServerCore& core() const { return core_; }
  [[nodiscard]] const std::shared_ptr<ClientState>& client() const { return client_; }

 private:
  template <class Context, class Job, class Finish>
  kj::Promise<void> begin_job(Role needed, Context context, Job job, Finish finish);

  ServerCore& core_;
  std::shared_ptr<ClientState> client_;
  CallLane lane_;
};

/// The current exception, thrown by the service, as an error. Only inside a catch block.
Error thrown_by_service(std::string_view noun);

template <class Job>
auto guarded(Job& job, std::string_view noun) -> std::invoke_result_t<Job&> {
  try {
    return job();
  } catch (...) {
    return thrown_by_service(noun);
  }
}

/// Calls the job, with the token where it takes one.
template <class Job>
auto run_job(Job& job, const std::stop_token& stop) {
  if constexpr (std::is_invocable_v<Job&, const std::stop_token&>) {
    return job(stop);
  } else {
    return job();
  }
}

/// Runs the job; calls `finish(outcome, results)` in the loop when it has ended or was refused.
template <class Context, class Job, class Finish>
kj::Promise<void> Caller::begin_job(Role needed, Context context, Job job, Finish finish) {
  using Outcome = decltype(run_job(job, std::stop_token()));
  struct Work {
    std::optional<Job> job;
    std::optional<Outcome> outcome;
    std::stop_source dropped{};
  };
  context.releaseParams();
  context.allowCancellation();
  auto work = std::make_shared<Work>();
  work->job.emplace(std::move(job));
  auto done = run(needed, [work, noun = core_.noun()] {
    auto bound = [&] { return run_job(*work->job, work->dropped.get_token()); };
    work->outcome.emplace(guarded(bound, noun));
    work->job.reset();
  });
  // Where the client waits no longer, the promise is destroyed before it is resolved.
  auto ended = kj::defer([work] { work->dropped.request_stop(); });
  return done
      .then([work, context, finish = std::move(finish)](Result<void>&& begun) mutable {
        if (!begun) work->outcome.emplace(begun.error());
        finish(*work->outcome, context.getResults());
      })
      .attach(kj::mv(ended));
}

/// Writes an outcome into the results: its error, or what `reply` makes of it.
template <class Outcome, class Results, class Reply>
void write_outcome(Outcome& outcome, Results results, Reply& reply) {
  if (!outcome) return encode(outcome.error(), results.initError());
  try {
    if constexpr (std::is_void_v<typename Outcome::value_type>) {
      reply(results);
    } else {
      reply(*outcome, results);
    }
  } catch (const WireError& failed) {
    encode(failed.error(), results.initError());
  }
}

template <class Context, class Job, class Reply>
kj::Promise<void> Caller::answer(Role needed, Context context, Job job, Reply reply) {
  return begin_job(needed, context, std::move(job),
                   [reply = std::move(reply)](auto& outcome, auto results) mutable {
                     write_outcome(outcome, results, reply);
                   });
}

template <class Context, class Job, class Reply>
kj::Promise<void> Caller::answer_here(Context context, Job job, Reply reply) {
  using Outcome = std::invoke_result_t<Job&>;
  const auto begun = begin();
  auto outcome = begun ? guarded(job, core_.noun()) : Outcome(begun.error());
  if (begun) end();
  write_outcome(outcome, context.getResults(), reply);
  return kj::READY_NOW;
}

template <class Context, class Job, class Done>
kj::Promise<void> Caller::answer_value(Role needed, Context context, Job job, Done done) {
  return begin_job(needed, context, std::move(job),
                   [done = std::move(done)](auto& outcome, auto results) mutable {
                     encode(outcome, results.initAnswer());
                     if (outcome) done(results);
                   });
}

}  // namespace segue::control::detail
