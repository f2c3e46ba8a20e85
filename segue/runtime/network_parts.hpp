// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <set>

namespace segue::runtime::detail {

/// The tasks of networks, whatever their incarnations, and their processes.
class NetworkParts {
 public:
  void add(const model::Network& network);
  /// Whether these do not care when an action ends: it moves another task through its life cycle, makes or
  /// ends a connection of another one, or begins or ends another process.
  [[nodiscard]] bool are_independent_of(const model::Action& action) const;

 private:
  [[nodiscard]] bool has(const model::TaskId& task) const;

  std::set<model::TaskId> tasks_;
  std::set<model::DeploymentKey> processes_;
};

/// The network without these processes, their tasks, and the connections of these.
model::Network without_processes(model::Network network, const std::set<model::DeploymentKey>& processes);

}  // namespace segue::runtime::detail
