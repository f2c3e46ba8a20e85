// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task_network/acts_ahead.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/task_network.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue::draw {

/// A task network before it runs, as lists and pictures show it: what its nodes are, what each comes after,
/// and why. Numbers are in program order. A plain value; one thread at a time.
struct Diagram {
  /// The kind of a node. Join: tells whether one of several ways was taken. Copy: hands on a value under a
  /// condition. Global: reads a global variable.
  enum class Role : std::uint8_t { Irreversible, Pure, Sensing, OpaqueSubtree, Join, Copy, Global };
  /// The reason why one node comes after another. World: a fact. Opaque, OpaqueSubtree: one of them may touch
  /// anything.
  enum class Kind : std::uint8_t { Data, Condition, World, Resource, Group, Opaque, OpaqueSubtree };
  static constexpr std::size_t kKinds = 7;

  /// One reason why a node comes after another.
  struct Cause {
    Kind kind = Kind::Data;
    std::string
        subject{};  ///< the input, outcome, fact or resource; of Opaque and OpaqueSubtree: who touches what
    std::string detail{};  ///< the output that becomes the input; what both do with the fact or resource; why
    std::uint32_t node = task_network::kNone;  ///< of Opaque and OpaqueSubtree: who that is
  };
  /// A node that comes before another, and why.
  struct Dependency {
    std::uint32_t from = 0;
    std::vector<Cause> causes;  ///< one at least; those that the engine keeps come first
    bool implied = false;       ///< others lead from the one to the other anyway
    bool holds_start = true;    ///< else it may run ahead, and only its result waits
  };
  /// The units of a resource that a node needs.
  struct Units {
    std::string resource;
    bool observed = false;  ///< a robot shows how many there are
  };
  /// A node with what it waits for.
  struct Node {
    std::string name;
    Role role = Role::Irreversible;
    std::string note{};  ///< why it is an opaque subtree, or reads what
    std::string
        container{};      ///< of a mission's state: the path of the state around; empty: the mission itself
    Duration duration{};  ///< expected
    bool strict = false;  ///< it starts when nothing before it can fail any more
    std::vector<Dependency> before{};
    std::vector<Units> units{};  ///< that it needs to begin
  };

  std::string name;
  std::vector<Node> nodes;
  std::uint32_t nodes_in_all = 0;  ///< of the network; `nodes` are the first of them
  bool strict = false;             ///< all nodes that are not pure are strict
  bool complete = true;            ///< nothing is to come
  std::string waits_for;           ///< what must be known before it goes on; empty: only the horizon ended it

  std::vector<task_network::NamedActsAhead>
      ahead{};  ///< shown below: what may happen although something earlier fails
  std::vector<task_network::NamedSensesAhead>
      senses_ahead{};          ///< shown below: what may sense before something earlier has acted
  bool ahead_complete = true;  ///< else only the first nodes were examined for this

  /// How many nodes have each role, and how many pairs of them are ordered.
  struct Counts {
    std::array<std::size_t, 7> roles{};
    std::size_t dependencies = 0;  ///< pairs of nodes
    std::size_t implied = 0;
  };
  [[nodiscard]] Counts counts() const;
};

std::string_view to_string(Diagram::Role role);
std::string_view to_string(Diagram::Kind kind);
/// "data pose -> goal", "world at(base): made true there, relied on here".
std::string to_string(const Diagram::Cause& cause);

/// The diagram of the first `most` nodes, without `ahead`. `further`: the dependencies that derive_order()
/// gives besides the order.
Diagram diagram_of(const task_network::TaskNetwork& network, const task_network::Order& order,
                   const std::vector<task_network::Dependency>& further,
                   std::size_t most = task_network::kNone);

/// A line for each node and each node that it comes after; what is implied comes last, and is marked.
std::string to_text(const Diagram& diagram);
/// The nodes, and for each the nodes that it comes after, as a map.
type::Value to_value(const Diagram& diagram);
/// The states or nodes that may act although something earlier fails, a line for each; "" if there are none.
std::string ahead_text(const std::vector<task_network::NamedActsAhead>& ahead, bool complete);
/// The states or nodes that may sense before something earlier has acted, a line for each; "" if there are
/// none.
std::string senses_text(const std::vector<task_network::NamedSensesAhead>& senses);
/// Those that may sense ahead, and those that may act ahead, as lists.
type::Value senses_value(const std::vector<task_network::NamedSensesAhead>& senses);
type::Value ahead_value(const std::vector<task_network::NamedActsAhead>& ahead);

/// The most nodes in a picture; further ones are left out.
inline constexpr std::size_t kMostDrawn = 1000;

/// A graph for Graphviz, with a cluster for each container; without what is implied.
std::string to_dot(const Diagram& diagram);
/// A drawing: nodes that can start at once on the left, nodes that come after others further right; without
/// implied dependencies.
std::string to_svg(const Diagram& diagram);

}  // namespace segue::draw
