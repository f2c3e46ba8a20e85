// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/known_faults.hpp>

#include <utility>

namespace segue::runtime::detail {

void KnownFaults::exchange(std::vector<UnresolvedFault>& kept, std::vector<UnresolvedFault> faults) {
  const bool has_any = !kept.empty() || !faults.empty();
  kept = std::move(faults);
  if (has_any) {
    changes_.add();
  }
}

void KnownFaults::set_unresolved(std::vector<UnresolvedFault> faults) {
  const Lock lock(mutex_);
  exchange(unresolved_, std::move(faults));
}

std::vector<UnresolvedFault> KnownFaults::unresolved() const {
  const Lock lock(mutex_);
  return unresolved_;
}

void KnownFaults::set_in_repair(std::vector<UnresolvedFault> faults) {
  const Lock lock(mutex_);
  exchange(in_repair_, std::move(faults));
}

std::vector<UnresolvedFault> KnownFaults::in_repair() const {
  const Lock lock(mutex_);
  return in_repair_;
}

void KnownFaults::set_handled(std::map<std::string, Handling> handled) {
  const Lock lock(mutex_);
  handled_ = std::move(handled);
}

std::map<std::string, Handling> KnownFaults::handled() const {
  const Lock lock(mutex_);
  return handled_;
}

void KnownFaults::process_ended(const model::DeploymentKey& process, const std::string& why) {
  const Lock lock(mutex_);
  ended_.insert_or_assign(process, why);
}

void KnownFaults::forget_ended_but(const std::set<model::DeploymentKey>& missing) {
  const Lock lock(mutex_);
  std::erase_if(ended_, [&](const auto& entry) { return !missing.contains(entry.first); });
}

std::map<model::DeploymentKey, std::string> KnownFaults::ended() const {
  const Lock lock(mutex_);
  return ended_;
}

}  // namespace segue::runtime::detail
