// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/host.capnp.h>
#include <segue/control/detail/tasks_wire.hpp>
#include <segue/hosts/host_service.hpp>

/// Encodes and decodes the messages of the daemons of computers. As in model_wire.hpp, messages are not
/// trusted, and unknown words in them throw WireError.
namespace segue::control::detail {

void encode(const hosts::HostInfo& info, wire::HostInfo::Builder builder);
hosts::HostInfo decode(wire::HostInfo::Reader reader);

void encode(const hosts::LeaseInfo& lease, wire::Lease::Builder builder);
hosts::LeaseInfo decode(wire::Lease::Reader reader);

void encode(const process::LogPosition& position, wire::LogPosition::Builder builder);
process::LogPosition decode(wire::LogPosition::Reader reader);

void encode(const hosts::LinkWait& link, wire::LinkWait::Builder builder);
hosts::LinkWait decode(wire::LinkWait::Reader reader);

void encode(const hosts::ModelFile& file, wire::ModelFile::Builder builder);
hosts::ModelFile decode(wire::ModelFile::Reader reader);

void encode(const hosts::HostView& view, wire::View::Builder builder);
hosts::HostView decode(wire::View::Reader reader);

/// A ComputerEvent and a LossEvent do not travel: only a runtime knows what it can reach and commands.
void encode(const host::HostEvent& event, wire::HostEvent::Builder builder);
host::HostEvent decode(wire::HostEvent::Reader reader);

}  // namespace segue::control::detail
