// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/stream_client.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

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
    auto answer = channel_->ask(look_timeout(wait), send, wait.stop);
    if (!answer) return answer.error();
    if (!answer->is_list())
      return fail(ErrorCode::Internal, channel_->who() + " sent samples that are no list");
    return std::move(answer->as_list());
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
