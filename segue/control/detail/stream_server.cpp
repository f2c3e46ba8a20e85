// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/stream_server.hpp>
#include <segue/rpc/detail/answer_later.hpp>

namespace segue::control::detail {

namespace {

constexpr std::size_t kMaxSamples = 10'000;

class StreamServer final : public wire::SampleStream::Server {
 public:
  StreamServer(Caller caller, std::shared_ptr<HeldStream> held)
      : caller_(std::move(caller)), held_(std::move(held)) {
    ++caller_.client()->streams;
  }

  /// Closing may wait for the port, so it is a job of the pool; where there is no thread, the loop waits.
  ~StreamServer() noexcept {
    --caller_.client()->streams;
    caller_.core().pool.submit([held = std::move(held_)] {});
  }

  kj::Promise<void> read(ReadContext context) override {
    const std::size_t limit = std::min<std::size_t>(context.getParams().getLimit(), kMaxSamples);
    return caller_.answer_value(context, [held = held_, limit] { return held->read(limit); });
  }

  kj::Promise<void> next(NextContext context) override {
    const auto params = context.getParams();
    return answer_later<std::vector<type::Value>>(
        Role::Observe, caller_, context,
        [held = held_, limit = std::min<std::size_t>(params.getLimit(), kMaxSamples),
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped,
                                                         task_host::SamplesAnswer answered) {
          held->next(limit, Wait(deadline, dropped), std::move(answered));
        },
        [](std::vector<type::Value>& samples, auto results) {
          put(type::Value(std::move(samples)), results.initSamples());
        });
  }

  kj::Promise<void> close(CloseContext context) override {
    return caller_.answer_value(context, [held = held_]() -> Result<type::Value> {
      held->close();
      return type::Value();
    });
  }

 private:
  Caller caller_;
  std::shared_ptr<HeldStream> held_;
};

}  // namespace

Result<type::Value> HeldStream::read(std::size_t limit) {
  const Lock lock(mutex);
  if (stream == nullptr) return fail(ErrorCode::InvalidState, "the stream is closed");
  auto samples = stream->read(limit);
  if (!samples) return samples.error();
  return type::Value(std::move(*samples));
}

void HeldStream::next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) {
  const Lock lock(mutex);
  if (stream == nullptr) return answered(fail(ErrorCode::InvalidState, "the stream is closed"));
  stream->next(limit, wait, std::move(answered));
}

void HeldStream::close() {
  const Lock lock(mutex);
  stream.reset();
}

wire::SampleStream::Client make_stream_server(const Caller& caller, std::shared_ptr<HeldStream> held) {
  return kj::heap<StreamServer>(caller, std::move(held));
}

}  // namespace segue::control::detail
