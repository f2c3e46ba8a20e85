// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/lease_owners.hpp>

namespace segue::control::detail {

void LeaseOwners::add(std::uint64_t lease, const Peer& owner) {
  const Lock lock(mutex_);
  owner_.insert_or_assign(lease, identity_of(owner));
}

void LeaseOwners::remove(std::uint64_t lease) {
  const Lock lock(mutex_);
  owner_.erase(lease);
}

std::optional<Error> LeaseOwners::refusal(std::uint64_t lease, const Peer& who) const {
  const Lock lock(mutex_);
  const auto found = owner_.find(lease);
  if (found == owner_.end() || found->second == identity_of(who)) return std::nullopt;
  return fail(ErrorCode::PermissionDenied, "that lease was given to somebody else");
}

}  // namespace segue::control::detail
