// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/base/result.hpp>
#include <segue/control/robot_request.hpp>
#include <segue/rpc/peer.hpp>

#include <string>

/// How requests and their senders travel.
namespace segue::control::detail {

/// ResourceExhausted where the properties do not fit into a message.
Result<void> encode(const RequestOptions& options, wire::RequestOptions::Builder builder);
/// `peer` sent it. InvalidArgument for words and properties that mean nothing here.
Result<RequestOptions> decode(wire::RequestOptions::Reader reader, const Peer& peer);

void encode(const Sender& sender, wire::Sender::Builder builder);
Sender decode(wire::Sender::Reader reader, const Peer& peer);

/// Who asks: what a client says of itself, behind what is known of one from another computer.
std::string who_asks(std::string said, const Peer& peer);

}  // namespace segue::control::detail
