// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/model.capnp.h>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/rpc/detail/wire.hpp>

#include <string>
#include <vector>

/// Encodes and decodes networks, transitions and component models, exactly but for their positions in files.
/// Messages are not trusted: unknown words and values beyond the limits throw WireError, malformed messages
/// kj::Exception. The receiver checks what they mean (names, sizes).
namespace segue::control::detail {

using Texts = std::vector<std::string>;

void encode(const Texts& texts, capnp::List<capnp::Text>::Builder builder);
Texts decode(capnp::List<capnp::Text>::Reader reader);

void encode(const Activity& activity, wire::Activity::Builder builder);
Activity decode(wire::Activity::Reader reader);

void encode(const model::PortRef& port, wire::PortRef::Builder builder);
model::PortRef decode(wire::PortRef::Reader reader);

void encode(const model::Connection& connection, wire::Connection::Builder builder);
model::Connection decode(wire::Connection::Reader reader);

void encode(const model::Task& task, wire::Task::Builder builder);
model::Task decode(wire::Task::Reader reader);

void encode(const model::Deployment& deployment, wire::Deployment::Builder builder);
model::Deployment decode(wire::Deployment::Reader reader);

void encode(const model::Network& network, wire::Network::Builder builder);
model::Network decode(wire::Network::Reader reader);

void encode(const model::Action& action, wire::Action::Builder builder);
/// The kind of an action determines the type of its subject.
model::Action decode(wire::Action::Reader reader);

void encode(const model::Transition& transition, wire::Transition::Builder builder);
model::Transition decode(wire::Transition::Reader reader);

void encode(const model::ComponentModel& model, wire::Component::Builder builder);
model::ComponentModel decode(wire::Component::Reader reader);

}  // namespace segue::control::detail
