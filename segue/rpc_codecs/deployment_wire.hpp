// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/deployment.capnp.h>
#include <segue/rpc_codecs/processes.capnp.h>
#include <segue/deploy/deployment_service.hpp>
#include <segue/process_server/process_service.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>

/// Encodes and decodes the messages of deployment processes and process servers. As in model_wire.hpp,
/// messages are not trusted, and unknown words in them throw WireError.
namespace segue::control::detail {

void encode(const deploy::DeploymentInfo& info, wire::Info::Builder builder);
deploy::DeploymentInfo decode(wire::Info::Reader reader);

void encode(const deploy::Snapshot& snapshot, wire::Snapshot::Builder builder);
deploy::Snapshot decode(wire::Snapshot::Reader reader);

void encode(const sample_link::OutputOrigin& origin, wire::Origin::Builder builder);
sample_link::OutputOrigin decode(wire::Origin::Reader reader);

void encode(const sample_link::InputPlace& place, wire::Place::Builder builder);
sample_link::InputPlace decode(wire::Place::Reader reader);

void encode(const Result<sample_link::OutputOrigin>& origin, wire::OriginOutcome::Builder builder);
Result<sample_link::OutputOrigin> decode(wire::OriginOutcome::Reader reader);

void encode(const Result<sample_link::InputPlace>& place, wire::PlaceOutcome::Builder builder);
Result<sample_link::InputPlace> decode(wire::PlaceOutcome::Reader reader);

void encode(const deploy::OpenInput& input, wire::OpenInput::Builder builder);
deploy::OpenInput decode(wire::OpenInput::Reader reader);

void encode(const deploy::AttachOutput& output, wire::AttachOutput::Builder builder);
deploy::AttachOutput decode(wire::AttachOutput::Reader reader);

void encode(const deploy::ArmCommit::Endpoint& endpoint, wire::EndingEndpoint::Builder builder);
deploy::ArmCommit::Endpoint decode(wire::EndingEndpoint::Reader reader);

void encode(const deploy::CloseEndpoint& endpoint, wire::CloseEndpoint::Builder builder);
deploy::CloseEndpoint decode(wire::CloseEndpoint::Reader reader);

void encode(const process_server::ExitReason& reason, wire::ExitReason::Builder builder);
process_server::ExitReason decode(wire::ExitReason::Reader reader);

void encode(const process_server::ProcessInfo& process, wire::ProcessInfo::Builder builder);
process_server::ProcessInfo decode(wire::ProcessInfo::Reader reader);

}  // namespace segue::control::detail
