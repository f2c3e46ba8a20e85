// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_connection.hpp>
#include <segue/sample_link/shared_input.hpp>
#include <segue/sample_link/shared_output.hpp>
#include <segue/task/port_access.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/type.hpp>

namespace segue::sample_link {

namespace {

/// Mappings begin at page boundaries, so no larger alignment can be kept.
constexpr std::size_t kMostAlignment = 4096;

Result<void> check_shared_policy(const Policy& policy) {
  if (auto checked = check_policy(policy); !checked) return checked;
  if (policy.size > SharedRing::kLargest) {
    return fail(ErrorCode::InvalidArgument, "a connection between processes can hold up to " +
                                                std::to_string(SharedRing::kLargest) + " samples, not " +
                                                std::to_string(policy.size));
  }
  if (policy.transport == Transport::Automatic || policy.transport == Transport::SharedMemory) return {};
  return fail(ErrorCode::Unsupported, "processes of one host are connected by shared memory, not by " +
                                          std::string(to_string(policy.transport)));
}

Result<std::shared_ptr<const PeerMemory>> find_peer(const SharedState& state, Incarnation incarnation,
                                                    const std::string& port) {
  auto peer = state.peer(incarnation);
  if (peer) return peer;
  return fail(ErrorCode::NotFound, "cannot connect " + port +
                                       ": the memory of the other process has not been admitted, or has "
                                       "been forgotten because that process is gone");
}

Result<void> check_samples(const task::PortBase& port) {
  const type::TypeInfo* info = port.type();
  if (info == nullptr) return {};
  if (form_of(info) == SampleForm::Flat && !type::can_flatten(*info)) {
    return fail(ErrorCode::Unsupported, "samples of " + port.full_name() + " cannot leave their process: " +
                                            quote(std::string(info->name())) +
                                            " has members without a description");
  }
  if (info->alignment <= kMostAlignment) return {};
  return fail(ErrorCode::Unsupported, "samples of " + port.full_name() +
                                          " cannot leave their process: aligned to " +
                                          std::to_string(info->alignment) + " bytes");
}

Result<void> check_place_type(const InputPlace& place, const task::OutputPortBase& port) {
  if (auto checked = check_topics(port, place.port, place.topic); !checked) return checked;
  const type::TypeInfo* written = port.type();
  if (place.any_type || written == nullptr) return {};
  if (place.type == written->name() && place.hash == written->hash) return {};
  return fail(ErrorCode::TypeMismatch, port.full_name() + " writes\n" + type::definition(*written->type) +
                                           "\nbut " + place.port + " reads\n" + place.definition +
                                           "\nconnect ports of one type, or put a converter between them");
}

/// The memory of the ring, if there is a ring of this generation and policy at the place. Pairs with H1, by
/// which the rest of the header is visible.
Result<std::byte*> find_ring(const PeerMemory& reader, const InputPlace& place, const Policy& policy) {
  std::byte* memory = reader.control(place.offset, SharedRing::bytes(policy));
  if (memory != nullptr && place.offset >= sizeof(PoolHeader) && place.generation != 0) {
    const RingHeader& header = SharedRing(memory, policy, place.generation).header();
    if (header.generation.load(std::memory_order_acquire) == place.generation &&
        header.kind.load(std::memory_order_relaxed) == static_cast<std::uint64_t>(policy.kind) &&
        header.size.load(std::memory_order_relaxed) == policy.size &&
        header.init.load(std::memory_order_relaxed) == (policy.init ? 1U : 0U)) {
      return memory;
    }
  }
  return fail(ErrorCode::InvalidArgument, "there is no connection of this policy at the place that " +
                                              place.port + " names; open the reader's endpoint again");
}

}  // namespace

OutputOrigin describe_output(const SharedMemory& memory, const task::OutputPortBase& port) {
  const type::TypeInfo* info = port.type();
  return {memory.incarnation(), info == nullptr ? 0 : info->size, form_of(info) == SampleForm::Flat};
}

Result<InputEndpoint> open_input(SharedMemory& memory, const OutputOrigin& origin, task::InputPortBase& port,
                                 const Policy& policy, task::CommitGatePtr gate) {
  if (auto checked = check_shared_policy(policy); !checked) return std::move(checked.error());
  if (auto checked = check_samples(port); !checked) return std::move(checked.error());
  const auto state = SharedState::of(memory);
  auto writer = find_peer(*state, origin.writer, port.full_name());
  if (!writer) return std::move(writer.error());
  std::shared_ptr<std::byte> place = state->control()->allocate(SharedRing::bytes(policy));
  if (!place) {
    return fail(ErrorCode::ResourceExhausted,
                "no shared memory is left for a connection to " + port.full_name() +
                    "; give the process a larger control pool, or connect with smaller buffers");
  }
  auto ring = std::make_shared<OwnedRing>(std::move(place), policy, state->next_generation());
  auto endpoint = std::make_shared<SharedInput>(state, std::move(*writer), std::move(ring), port, policy,
                                                origin.sample_size == 0, std::move(gate));
  if (auto opened = endpoint->open(); !opened) return std::move(opened.error());
  return InputEndpoint{endpoint, endpoint->place()};
}

void release_input(SharedMemory& memory, const InputPlace& place) {
  SharedState::of(memory)->release(place);
}

Result<std::shared_ptr<SharedEndpoint>> attach_output(SharedMemory& memory, const InputPlace& place,
                                                      task::OutputPortBase& port, const Policy& policy,
                                                      task::CommitGatePtr gate) {
  if (auto checked = check_shared_policy(policy); !checked) return std::move(checked.error());
  if (auto checked = check_place_type(place, port); !checked) return std::move(checked.error());
  if (auto checked = check_samples(port); !checked) return std::move(checked.error());
  const auto state = SharedState::of(memory);
  auto reader = find_peer(*state, place.reader, port.full_name());
  if (!reader) return std::move(reader.error());
  auto ring = find_ring(**reader, place, policy);
  if (!ring) return std::move(ring.error());
  state->drop_ended();
  if (writes_in_place(port) && !place.any_type) {
    if (auto shared = task::OutputPortAccess::share(port, state->payload()); !shared)
      return std::move(shared.error());
  }
  auto endpoint =
      std::make_shared<SharedOutput>(state, std::move(*reader), *ring, place, port, policy, std::move(gate));
  if (auto attached = endpoint->attach(); !attached) return std::move(attached.error());
  return std::shared_ptr<SharedEndpoint>(std::move(endpoint));
}

}  // namespace segue::sample_link
