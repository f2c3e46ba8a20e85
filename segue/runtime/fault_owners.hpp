// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/runtime/controller_registry.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/supervision.hpp>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// Says which of the controllers that run together a fault concerns.
class FaultOwners {
 public:
  /// `running` must outlive this.
  FaultOwners(const model::Network& running, const ControllerRegistry& known);

  /// Those that have the part; all where none has it, as with a gateway.
  [[nodiscard]] std::vector<model::NetworkName> of(const DetectedFault& fault) const;
  [[nodiscard]] UnresolvedFault unresolved(const DetectedFault& fault, std::string sentence) const;

 private:
  [[nodiscard]] std::vector<model::TaskId> tasks_of(const DetectedFault& fault) const;

  const model::Network& running_;
  const std::vector<model::NetworkName> names_;
  std::map<model::NetworkName, std::set<model::TaskId>> tasks_;
};

}  // namespace segue::runtime::detail
