// SPDX-License-Identifier: Apache-2.0
#include "implied.hpp"

#include <bitset>

namespace segue::task_network {

namespace {

/// A set of nodes relative to one: bit k is the k-th node before it.
using Window = std::bitset<kImpliedWithin>;

class ImpliedFinder {
 public:
  ImpliedFinder(const TaskNetwork& network, const Order& order)
      : network_(network), order_(order), passed_(kImpliedWithin), conditions_(kImpliedWithin) {}

  std::vector<bool> find() {
    std::vector<bool> implied;
    implied.reserve(order_.dependency_count());
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      look_back(i);
      for (const Dependency& dependency : order_.before(NodeId{i}))
        implied.push_back(is_implied(dependency));
    }
    return implied;
  }

 private:
  static std::uint32_t distance(const Dependency& dependency) {
    return index(dependency.to) - index(dependency.from);
  }
  /// A resource dependency only orders starts, so a path over it does not ensure that `from` has ended.
  static bool tells_of_the_end(const Dependency& dependency) {
    return dependency.reason() != Reason::Resource;
  }
  /// Whether `to` does not even run before `from` has passed.
  [[nodiscard]] bool holds_until_the_end(const Dependency& dependency) const {
    if (!tells_of_the_end(dependency)) return false;
    const bool irreversible = network_[dependency.to].kind == ActionClass::Irreversible;
    return irreversible || (dependency.reason() != Reason::Data && holds_start(network_, dependency));
  }

  void look_back(std::uint32_t node) {
    Window direct;
    Window direct_conditions;
    behind_.reset();
    behind_held_.reset();
    behind_conditions_.reset();
    for (const Dependency& dependency : order_.before(NodeId{node})) {
      const std::uint32_t away = distance(dependency);
      if (away >= kImpliedWithin || !tells_of_the_end(dependency)) continue;
      const std::size_t row = index(dependency.from) % kImpliedWithin;
      const Window further = passed_[row] << away;
      behind_ |= further;
      if (holds_until_the_end(dependency)) behind_held_ |= further;
      direct.set(away);
      if (dependency.reason() != Reason::Condition) continue;
      behind_conditions_ |= conditions_[row] << away;
      direct_conditions.set(away);
    }
    passed_[node % kImpliedWithin] = behind_ | direct;
    conditions_[node % kImpliedWithin] = behind_conditions_ | direct_conditions;
  }

  [[nodiscard]] bool is_implied(const Dependency& dependency) const {
    const std::uint32_t away = distance(dependency);
    if (away >= kImpliedWithin || dependency.reason() == Reason::Data) return false;
    if (dependency.reason() == Reason::Condition) return behind_conditions_[away];
    return holds_start(network_, dependency) ? behind_held_[away] : behind_[away];
  }

  const TaskNetwork& network_;
  const Order& order_;
  std::vector<Window> passed_;      ///< by node, modulo: those that have passed when it passes
  std::vector<Window> conditions_;  ///< by node, modulo: those whose outcomes put it on the path
  Window behind_;                   ///< of the current node: nodes behind its direct predecessors
  Window behind_held_;              ///< of the current node: nodes behind those that delay its start
  Window behind_conditions_;
};

}  // namespace

std::vector<bool> implied_dependencies(const TaskNetwork& network, const Order& order) {
  if (order.dependency_count() == 0) return {};
  return ImpliedFinder(network, order).find();
}

}  // namespace segue::task_network
