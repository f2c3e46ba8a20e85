// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/control/detail/robot_server.hpp>
#include <segue/control/detail/wire.hpp>

#include <algorithm>
#include <exception>
#include <mutex>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

constexpr std::size_t kMaxCallsPerClient = 16;
constexpr std::size_t kMaxStreamsPerClient = 256;
constexpr std::size_t kMaxBuffer = 1 << 16;
constexpr std::size_t kMaxSamples = 10'000;
constexpr Duration kMaxTimeout = std::chrono::hours(24);
constexpr Duration kEventSlice = std::chrono::milliseconds(100);
constexpr std::uint64_t kMaxNodes = kServerMessageWords;

TimePoint deadline_after(std::int64_t timeout) {
  return RealClock::instance().now() + std::clamp(Duration(timeout), Duration(0), kMaxTimeout);
}

Result<Value> guarded(const Caller::Job& job) {
  try {
    return job();
  } catch (const std::exception& exception) {
    return fail(ErrorCode::Internal, std::string("the robot's service failed: ") + exception.what());
  } catch (...) {
    return fail(ErrorCode::Internal, "the robot's service failed");
  }
}

/// A call without a result as one with the result null.
Result<Value> as_value(const Result<void>& outcome) {
  if (!outcome) return outcome.error();
  return Value();
}

/// Waits in slices, so that a server that stops need not wait for its most patient client.
Result<Value> wait_for_events(ServerCore& core, std::uint64_t after, TimePoint deadline) {
  for (;;) {
    const Duration left = deadline - RealClock::instance().now();
    auto events = core.service.events(after, std::clamp(left, Duration(0), kEventSlice));
    const bool some = events && events->is_list() && !events->as_list().empty();
    if (!events || some || left <= kEventSlice || core.stopping) return events;
  }
}

/// A service's stream: read by one thread at a time.
struct HeldStream {
  std::mutex mutex;
  std::unique_ptr<SampleStream> stream;

  Result<Value> read(std::size_t limit) {
    const std::lock_guard lock(mutex);
    auto samples = stream->read(limit);
    if (!samples) return samples.error();
    return Value(std::move(*samples));
  }
};

class StreamServer final : public wire::SampleStream::Server {
 public:
  StreamServer(Caller caller, std::shared_ptr<HeldStream> held)
      : caller_(std::move(caller)), held_(std::move(held)) {
    ++caller_.client()->streams;
  }

  /// Closing may wait for the port, so it is a job; where none is to be had, the loop has to wait.
  ~StreamServer() noexcept {
    --caller_.client()->streams;
    caller_.core().pool.submit([held = std::move(held_)] {});
  }

  kj::Promise<void> read(ReadContext context) override {
    const std::size_t limit = std::min<std::size_t>(context.getParams().getLimit(), kMaxSamples);
    return caller_.answer(context, [held = held_, limit] { return held->read(limit); });
  }

 private:
  Caller caller_;
  std::shared_ptr<HeldStream> held_;
};

class RobotServer final : public wire::Robot::Server {
 public:
  explicit RobotServer(Caller caller) : caller_(std::move(caller)) {}

  kj::Promise<void> status(StatusContext context) override {
    return caller_.answer(context, [&service = caller_.service()] { return service.status(); });
  }

  kj::Promise<void> task(TaskContext context) override {
    return caller_.answer(context,
                          [&service = caller_.service(), id = as_string(context.getParams().getId())] {
                            return service.task(id);
                          });
  }

  kj::Promise<void> switchTo(SwitchToContext context) override {
    const auto params = context.getParams();
    return caller_.answer(context,
                          [&service = caller_.service(), controller = as_string(params.getController()),
                           dry_run = params.getDryRun(), order = as_string(params.getOrder()),
                           deadline = deadline_after(params.getTimeout())] {
                            return service.switch_to(controller, dry_run, order, deadline);
                          });
  }

  kj::Promise<void> applyTransition(ApplyTransitionContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context, [&service = caller_.service(), text = as_string(params.getText()),
                  file = as_string(params.getFile()), deadline = deadline_after(params.getTimeout())] {
          return service.apply_transition(text, file, deadline);
        });
  }

  kj::Promise<void> resetBelief(ResetBeliefContext context) override {
    return caller_.answer(context,
                          [&service = caller_.service()] { return as_value(service.reset_belief()); });
  }

  kj::Promise<void> setProperty(SetPropertyContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context,
        [&service = caller_.service(), task = as_string(params.getTask()),
         property = as_string(params.getProperty()), value = decode(params.getValue(), kMaxNodes),
         deadline = deadline_after(params.getTimeout())]() -> Result<Value> {
          if (!value) return value.error();
          return as_value(service.set_property(task, property, *value, deadline));
        });
  }

  kj::Promise<void> call(CallContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context,
        [&service = caller_.service(), task = as_string(params.getTask()),
         operation = as_string(params.getOperation()), arguments = decode(params.getArguments(), kMaxNodes),
         deadline = deadline_after(params.getTimeout())]() -> Result<Value> {
          if (!arguments) return arguments.error();
          return service.call(task, operation, *arguments, deadline);
        });
  }

  kj::Promise<void> openPort(OpenPortContext context) override {
    const auto params = context.getParams();
    const auto held = std::make_shared<HeldStream>();
    auto job = [&service = caller_.service(), held, task = as_string(params.getTask()),
                port = as_string(params.getPort()),
                buffer = std::clamp<std::size_t>(params.getBuffer(), 1, kMaxBuffer)]() -> Result<Value> {
      auto stream = service.open_port(task, port, buffer);
      if (!stream) return stream.error();
      held->stream = std::move(*stream);
      return Value(held->stream->type_name());
    };
    if (caller_.client()->streams >= kMaxStreamsPerClient) {
      encode(fail(ErrorCode::ResourceExhausted, "this client reads too many ports at once; close some"),
             context.getResults().initAnswer().initError());
      return kj::READY_NOW;
    }
    context.allowCancellation();
    return caller_.run(std::move(job)).then([context, held, caller = caller_](Result<Value>&& type) mutable {
      auto results = context.getResults();
      encode(type, results.initAnswer());
      if (type) results.setStream(kj::heap<StreamServer>(caller, held));
    });
  }

  kj::Promise<void> events(EventsContext context) override {
    const auto params = context.getParams();
    return caller_.answer(context, [&core = caller_.core(), after = params.getAfter(),
                                    deadline = deadline_after(params.getWait())] {
      return wait_for_events(core, after, deadline);
    });
  }

  kj::Promise<void> history(HistoryContext context) override {
    return caller_.answer(context, [&service = caller_.service()] { return service.history(); });
  }

  kj::Promise<void> shutDown(ShutDownContext context) override {
    return caller_.answer(context, [&service = caller_.service()] { return as_value(service.shut_down()); });
  }

 private:
  Caller caller_;
};

}  // namespace

kj::Promise<Result<Value>> Caller::run(Job job) {
  using Fulfiller = kj::Own<kj::PromiseFulfiller<Result<Value>>>;
  if (core_.stopping) return Result<Value>(fail(ErrorCode::Unavailable, "the robot is shutting down"));
  if (client_->calls >= kMaxCallsPerClient) {
    return Result<Value>(fail(ErrorCode::ResourceExhausted,
                              "this client has too many calls in progress; wait for one to end"));
  }
  auto pair = kj::newPromiseAndFulfiller<Result<Value>>();
  // Copyable, as std::function wants it; in truth it only ever moves, and ends in the loop's thread.
  auto fulfiller = std::make_shared<Fulfiller>(kj::mv(pair.fulfiller));
  const bool begun = core_.pool.submit([&loop = core_.loop, job = std::move(job), fulfiller,
                                        client = client_]() mutable {
    auto outcome = std::make_shared<Result<Value>>(guarded(job));
    job = nullptr;
    loop.post([fulfiller = std::move(fulfiller), client = std::move(client), outcome](kj::AsyncIoContext&) {
      --client->calls;
      (*fulfiller)->fulfill(std::move(*outcome));
    });
  });
  if (!begun) {
    return Result<Value>(
        fail(ErrorCode::ResourceExhausted, "the robot has too many calls in progress; try again"));
  }
  ++client_->calls;
  return kj::mv(pair.promise);
}

template <class Context>
kj::Promise<void> Caller::answer(Context context, Job job) {
  context.releaseParams();
  context.allowCancellation();
  return run(std::move(job)).then([context](Result<Value>&& outcome) mutable {
    encode(outcome, context.getResults().initAnswer());
  });
}

wire::Robot::Client make_robot_server(ServerCore& core, std::shared_ptr<ClientState> client) {
  return kj::heap<RobotServer>(Caller(core, std::move(client)));
}

}  // namespace segue::control::detail
