// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/participant_entities.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>

#include <algorithm>
#include <iterator>

namespace segue::ros2::wire {

/// Before Iron (24 bytes) and since (16 bytes).
template <std::size_t Size>
struct Identifier {
  std::array<std::uint8_t, Size> data{};
};
template <std::size_t Size>
struct Node {
  std::string node_namespace;
  std::string node_name;
  std::vector<Identifier<Size>> reader_gid_seq;
  std::vector<Identifier<Size>> writer_gid_seq;
};
template <std::size_t Size>
struct Participant {
  Identifier<Size> gid;
  std::vector<Node<Size>> node_entities_info_seq;
};

using Identifier16 = Identifier<16>;
using Node16 = Node<16>;
using Participant16 = Participant<16>;
using Identifier24 = Identifier<24>;
using Node24 = Node<24>;
using Participant24 = Participant<24>;

SEGUE_TYPE(Identifier16, data)
SEGUE_TYPE(Node16, node_namespace, node_name, reader_gid_seq, writer_gid_seq)
SEGUE_TYPE(Participant16, gid, node_entities_info_seq)
SEGUE_TYPE(Identifier24, data)
SEGUE_TYPE(Node24, node_namespace, node_name, reader_gid_seq, writer_gid_seq)
SEGUE_TYPE(Participant24, gid, node_entities_info_seq)

}  // namespace segue::ros2::wire

namespace segue::ros2 {
namespace {

template <std::size_t Size>
Gid gid_of(const wire::Identifier<Size>& identifier) {
  Gid gid{};
  std::copy_n(identifier.data.begin(), gid.size(), gid.begin());
  return gid;
}

template <std::size_t Size>
std::optional<ParticipantEntities> decode(std::span<const std::byte> message) {
  wire::Participant<Size> read;
  if (!type::read_cdr(type::type_info<wire::Participant<Size>>(), &read, message)) return {};
  ParticipantEntities entities{gid_of(read.gid), {}, Size == 24};
  for (wire::Node<Size>& node : read.node_entities_info_seq) {
    NodeEntities& one = entities.nodes.emplace_back(
        NodeEntities{std::move(node.node_namespace), std::move(node.node_name), {}, {}});
    std::ranges::transform(node.reader_gid_seq, std::back_inserter(one.subscriptions), gid_of<Size>);
    std::ranges::transform(node.writer_gid_seq, std::back_inserter(one.publishers), gid_of<Size>);
  }
  return entities;
}

template <std::size_t Size>
wire::Identifier<Size> on_wire(const Gid& gid) {
  wire::Identifier<Size> identifier;
  std::ranges::copy(gid, identifier.data.begin());
  return identifier;
}

template <std::size_t Size>
std::vector<std::byte> encode_with(const ParticipantEntities& entities) {
  wire::Participant<Size> written{on_wire<Size>(entities.participant), {}};
  for (const NodeEntities& node : entities.nodes) {
    auto& one =
        written.node_entities_info_seq.emplace_back(wire::Node<Size>{node.name_space, node.name, {}, {}});
    std::ranges::transform(node.subscriptions, std::back_inserter(one.reader_gid_seq), on_wire<Size>);
    std::ranges::transform(node.publishers, std::back_inserter(one.writer_gid_seq), on_wire<Size>);
  }
  const type::TypeInfo& info = type::type_info<wire::Participant<Size>>();
  std::vector<std::byte> bytes(type::cdr_size(info, &written));
  type::write_cdr(info, &written, bytes);
  return bytes;
}

/// "/" or "/robot/arm"
bool is_name_space(std::string_view name) {
  return name == "/" ||
         (name.starts_with('/') && std::ranges::all_of(split(name.substr(1), '/'), is_topic_token));
}

Result<void> check(const NodeEntities& node, const Gid& sender) {
  constexpr std::size_t kLongestName = 255;  // rmw's RMW_NODE_NAME_MAX_NAME_LENGTH
  if (node.name.size() > kLongestName || node.name_space.size() > kLongestName ||
      !is_topic_token(node.name) || !is_name_space(node.name_space)) {
    return fail(ErrorCode::InvalidArgument, "it has a node whose name is not a valid one");
  }
  const auto is_own = [&](const Gid& endpoint) { return same_participant(endpoint, sender); };
  if (std::ranges::all_of(node.subscriptions, is_own) && std::ranges::all_of(node.publishers, is_own))
    return {};
  return fail(ErrorCode::InvalidArgument,
              "it says that node " + full_name(node) + " has endpoints of others");
}

}  // namespace

std::string full_name(const NodeEntities& node) {
  return node.name_space.ends_with('/') ? node.name_space + node.name : node.name_space + "/" + node.name;
}

std::vector<std::byte> encode(const ParticipantEntities& entities) {
  return entities.before_iron ? encode_with<24>(entities) : encode_with<16>(entities);
}

std::optional<ParticipantEntities> decode_participant_entities(std::span<const std::byte> message) {
  if (auto entities = decode<16>(message)) return entities;
  return decode<24>(message);
}

Result<void> check(const ParticipantEntities& entities, const Gid& sender) {
  if (!same_participant(entities.participant, sender))
    return fail(ErrorCode::InvalidArgument, "it speaks for another participant");
  if (entities.nodes.size() > kMostNodes) {
    return fail(ErrorCode::InvalidArgument, "it has " + counted(entities.nodes.size(), "node") +
                                                ", more than the " + std::to_string(kMostNodes) +
                                                " that are taken");
  }
  for (const NodeEntities& node : entities.nodes) {
    if (auto checked = check(node, sender); !checked) return checked;
  }
  return {};
}

}  // namespace segue::ros2
