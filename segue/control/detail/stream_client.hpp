// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_service.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>

#include <memory>

namespace segue::control::detail {

/// The stream of samples that Connection::open() has opened under that id. Keeps the channel alive, and
/// closes the stream on the other side when it is destroyed.
Result<std::unique_ptr<SampleStream>> opened_stream(std::shared_ptr<RpcChannel> channel,
                                                    RpcChannel::StreamId id,
                                                    const Result<type::Value>& type_name);

}  // namespace segue::control::detail
