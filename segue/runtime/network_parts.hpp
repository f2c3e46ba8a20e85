// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <set>

namespace segue::runtime::detail {

/// The tasks of networks, whatever their incarnations.
class NetworkParts {
 public:
  void add(const model::Network& network);
  /// Whether what runs without an action, or ends with it late, is none of these tasks: it moves another task
  /// through its life cycle, or makes or ends a connection of another one. Actions on processes are not
  /// independent of anything.
  [[nodiscard]] bool are_independent_of(const model::Action& action) const;

 private:
  [[nodiscard]] bool has(const model::TaskId& task) const;

  std::set<model::TaskId> tasks_;
};

}  // namespace segue::runtime::detail
