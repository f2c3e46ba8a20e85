// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

/// Concurrent dataflow task networks: nodes in program order, the partial order that follows from their
/// facts, data, conditions and resources, and the engine that runs them concurrently and speculatively within
/// it.
namespace segue::task_network {

/// Dense numbers, strong by type: positions in the tables that hold what they name.
enum class FactId : std::uint32_t {};
enum class ResourceId : std::uint32_t {};
enum class OutcomeId : std::uint16_t {};
/// A node's position in program order: its place in the sequential execution.
enum class NodeId : std::uint32_t {};

template <class Id>
constexpr std::uint32_t index(Id id) {
  return static_cast<std::uint32_t>(id);
}

/// "none" wherever a 32-bit position is stored.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Outcomes that every network knows; further ones are interned by name.
inline constexpr OutcomeId kSuccess{0};
inline constexpr OutcomeId kAborted{1};
inline constexpr OutcomeId kPreempted{2};

/// A fact with the value it must have, or gets.
struct Literal {
  FactId fact{};
  bool value = true;
  friend bool operator==(const Literal&, const Literal&) = default;
};

}  // namespace segue::task_network
