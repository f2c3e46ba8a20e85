// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_service.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>

#include <memory>

namespace segue::control::detail {

/// The lease that Connection::open() has opened under that id: a stream of news, whose type is its number.
/// Keeps the channel alive. Its destructor waits until the lease has ended, so that the next request for a
/// lease succeeds; where that fails, the lease ends with the connection.
Result<std::unique_ptr<RobotLease>> opened_lease(std::shared_ptr<RpcChannel> channel, RpcChannel::StreamId id,
                                                 const Result<type::Value>& number);

}  // namespace segue::control::detail
