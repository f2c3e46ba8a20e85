// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/host.capnp.h>
#include <segue/distributed/host_service.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>

/// Encodes and decodes the messages of the daemons of computers. As in model_wire.hpp, messages are not
/// trusted, and unknown words in them throw WireError.
namespace segue::control::detail {

void encode(const distributed::HostInfo& info, wire::HostInfo::Builder builder);
distributed::HostInfo decode(wire::HostInfo::Reader reader);

void encode(const distributed::LeaseInfo& lease, wire::Lease::Builder builder);
distributed::LeaseInfo decode(wire::Lease::Reader reader);

void encode(const process_server::LogPosition& position, wire::LogPosition::Builder builder);
process_server::LogPosition decode(wire::LogPosition::Reader reader);

void encode(const distributed::LinkWait& link, wire::LinkWait::Builder builder);
distributed::LinkWait decode(wire::LinkWait::Reader reader);

void encode(const distributed::ModelFile& file, wire::ModelFile::Builder builder);
distributed::ModelFile decode(wire::ModelFile::Reader reader);

void encode(const distributed::HostView& view, wire::View::Builder builder);
distributed::HostView decode(wire::View::Reader reader);

/// A ComputerEvent and a LossEvent do not travel: only a runtime knows what it can reach and commands.
void encode(const task_host::HostEvent& event, wire::HostEvent::Builder builder);
task_host::HostEvent decode(wire::HostEvent::Reader reader);

}  // namespace segue::control::detail
