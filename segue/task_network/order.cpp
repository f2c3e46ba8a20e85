// SPDX-License-Identifier: Apache-2.0
#include "order.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace segue::task_network {

std::string_view to_string(Reason reason) {
  static constexpr std::array<std::string_view, 5> kNames{"fact", "resource", "data", "condition", "place"};
  return kNames[static_cast<std::size_t>(reason)];
}

std::string subject_text(const TaskNetwork& network, const Dependency& dependency) {
  switch (dependency.reason()) {
    case Reason::Fact:
      return network.facts.text(FactId{dependency.subject});
    case Reason::Resource:
      return network.resources.name(ResourceId{dependency.subject});
    case Reason::Data: {
      const std::string& name = network.names.name(dependency.subject);
      return name.starts_with('#') ? name.substr(1) : name;  // made up by who made the network
    }
    case Reason::Condition:
      return network.outcomes.name(dependency.subject);
    case Reason::Place:
      break;
  }
  return "its place in the program";
}

void Order::open_node() {
  first_block_.push_back(kNone);
}

Dependency dependency(NodeId from, NodeId to, Reason reason, std::uint32_t subject) {
  Dependency made;
  made.from = from;
  made.to = to;
  made.subject = subject & ((1U << 29) - 1);
  made.reason_bits = static_cast<std::uint32_t>(reason) & 7U;
  return made;
}

void Order::add(NodeId from, Reason reason, std::uint32_t subject) {
  dependencies_.push_back(dependency(from, NodeId{size() - 1}, reason, subject));
}

void Order::close_node() {
  begin_.push_back(static_cast<std::uint32_t>(dependencies_.size()));
}

/// The block has no end yet: it is where the next dependency of the node goes.
void Order::open_block(NodeId node, std::uint32_t place) {
  std::uint32_t& first = first_block_[index(node)];
  blocks_.push_back({place, place, first});
  first = static_cast<std::uint32_t>(blocks_.size()) - 1;
}

/// Linear, but for dependencies on nodes of earlier calls, which are sorted.
void Order::link() {
  const std::uint32_t first = std::exchange(linked_nodes_, size());
  const std::span<const Dependency> added = std::span(dependencies_).subspan(linked_.size());
  std::vector<Dependency> on_earlier;
  std::vector<std::uint32_t> counts(size() - first);  // by new node
  for (const Dependency& each : added) {
    if (index(each.from) < first)
      on_earlier.push_back(each);
    else
      ++counts[index(each.from) - first];
  }
  std::ranges::stable_sort(on_earlier, {}, &Dependency::from);
  auto place = static_cast<std::uint32_t>(linked_.size());
  linked_.insert(linked_.end(), on_earlier.begin(), on_earlier.end());
  for (const Dependency& each : on_earlier) {
    if (blocks_.empty() || linked_[blocks_.back().begin].from != each.from) open_block(each.from, place);
    blocks_.back().end = ++place;
  }
  linked_.resize(dependencies_.size());
  for (std::uint32_t i = 0; i < counts.size(); place += counts[i++]) {
    if (counts[i] > 0) open_block(NodeId{first + i}, place);
  }
  for (const Dependency& each : added) {
    if (index(each.from) >= first) linked_[blocks_[first_block_[index(each.from)]].end++] = each;
  }
}

void Order::reserve(std::size_t nodes, std::size_t dependencies) {
  dependencies_.reserve(dependencies);
  begin_.reserve(nodes + 1);
  first_block_.reserve(nodes);
}

std::size_t Order::bytes() const {
  return (dependencies_.size() + linked_.size()) * sizeof(Dependency) + blocks_.size() * sizeof(Block) +
         (begin_.size() + first_block_.size()) * sizeof(std::uint32_t);
}

}  // namespace segue::task_network
