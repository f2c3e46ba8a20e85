// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/stream_client.hpp>
#include <segue/rpc/detail/ask_later.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

Result<std::vector<Value>> samples_in(Value answer) {
  if (!answer.is_list()) return fail(ErrorCode::Internal, "the samples that were sent are not a list");
  return std::move(answer.as_list());
}

class ClientStream final : public SampleStream {
 public:
  ClientStream(std::shared_ptr<RpcChannel> channel, RpcChannel::StreamId id, std::string type)
      : channel_(std::move(channel)), id_(id), type_(std::move(type)) {}
  ~ClientStream() override { channel_->close_stream(id_); }

  Result<std::vector<Value>> read(std::size_t limit, const Wait& wait) override {
    const auto send = [id = id_, limit](RpcChannel::Connection& connection) {
      auto request = connection.held<wire::SampleStream>(id).readRequest();
      request.setLimit(static_cast<std::uint32_t>(std::min<std::size_t>(limit, UINT32_MAX)));
      return RpcChannel::send(request);
    };
    auto answer = channel_->ask(query_timeout(wait), send, wait.stop);
    if (!answer) return answer.error();
    return samples_in(std::move(*answer));
  }

  void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) override {
    using Samples = std::vector<Value>;
    ask_later<Samples>(
        *channel_, wait, std::move(answered),
        [id = id_, limit](RpcChannel::Connection& connection, Duration left) {
          auto request = connection.held<wire::SampleStream>(id).nextRequest();
          request.setLimit(static_cast<std::uint32_t>(std::min<std::size_t>(limit, UINT32_MAX)));
          request.setTimeout(left.count());
          return RpcChannel::send<Samples>(
              request, [](auto& results) { return samples_in(get(results.getSamples())); });
        });
  }

  [[nodiscard]] std::string type_name() const override { return type_; }

 private:
  std::shared_ptr<RpcChannel> channel_;
  RpcChannel::StreamId id_;
  std::string type_;
};

}  // namespace

Result<std::unique_ptr<SampleStream>> opened_stream(std::shared_ptr<RpcChannel> channel,
                                                    RpcChannel::StreamId id, const Result<Value>& type_name) {
  if (!type_name) return type_name.error();
  return std::make_unique<ClientStream>(std::move(channel), id,
                                        type_name->is_string() ? type_name->as_string() : std::string());
}

}  // namespace segue::control::detail
