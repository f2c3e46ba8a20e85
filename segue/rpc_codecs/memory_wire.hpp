// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/deployment.capnp.h>
#include <segue/base/descriptor.hpp>
#include <segue/sample_link/shared_memory.hpp>

#include <kj/async.h>

/// File descriptors as capabilities. To be used in an event loop.
namespace segue::control::detail {

/// The descriptors of `offer` are sent with the message, and closed when the other side has released them.
void encode(sample_link::MemoryOffer offer, wire::Offer::Builder builder);

/// The descriptors are duplicated. ParseError where a capability carries none, ResourceExhausted where the
/// system has none left. `reader` is only used until this returns.
kj::Promise<Result<sample_link::MemoryOffer>> decode(wire::Offer::Reader reader);

/// A single file.
wire::Memory::Client encode(Descriptor descriptor);
kj::Promise<Result<Descriptor>> decode(wire::Memory::Client memory);

}  // namespace segue::control::detail
