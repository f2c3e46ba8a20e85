// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/control/sample_stream.hpp>
#include <segue/rpc/detail/caller.hpp>

#include <algorithm>
#include <memory>
#include <utility>

namespace segue::control::detail {

constexpr std::size_t kMaxStreamsPerClient = 256;
constexpr std::size_t kMaxBuffer = 1 << 16;

/// A service's stream: read by one thread at a time.
struct HeldStream {
  Mutex mutex;
  std::unique_ptr<SampleStream> stream SEGUE_GUARDED_BY(mutex);  ///< null after close()

  Result<type::Value> read(std::size_t limit);
  void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered);
  void close();
};

/// Offers a stream to one client until the client releases it.
wire::SampleStream::Client make_stream_server(const Caller& caller, std::shared_ptr<HeldStream> held);

/// Answers with the stream that `open` (a Result<std::unique_ptr<SampleStream>>) returns. The results have an
/// `answer`, which is the name of its type, and a `stream`.
template <class Context, class Open>
kj::Promise<void> answer_stream(Caller& caller, Role needed, Context context, Open open) {
  if (caller.client()->streams >= kMaxStreamsPerClient) {
    encode(fail(ErrorCode::ResourceExhausted, "this client reads too many ports at once; close some"),
           context.getResults().initAnswer().initError());
    return kj::READY_NOW;
  }
  const auto held = std::make_shared<HeldStream>();
  auto job = [held, open = std::move(open)]() -> Result<type::Value> {
    auto stream = open();
    if (!stream) return stream.error();
    const Lock lock(held->mutex);
    held->stream = std::move(*stream);
    return type::Value(held->stream->type_name());
  };
  return caller.answer_value(needed, context, std::move(job), [caller, held](auto results) {
    results.setStream(make_stream_server(caller, held));
  });
}
template <class Context, class Open>
kj::Promise<void> answer_stream(Caller& caller, Context context, Open open) {
  return answer_stream(caller, Role::Observe, context, std::move(open));
}

}  // namespace segue::control::detail
