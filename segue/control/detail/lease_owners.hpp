// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/peer.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace segue::control::detail {

/// The owners of the leases that a server has given out, so that nobody else can use a number that was found
/// out. Thread safe.
class LeaseOwners {
 public:
  void add(std::uint64_t lease, const Peer& owner);
  void remove(std::uint64_t lease);
  /// PermissionDenied where that lease was given to somebody else. Nothing for other numbers: only the robot
  /// knows whether such a lease is held.
  [[nodiscard]] std::optional<Error> refusal(std::uint64_t lease, const Peer& who) const;

 private:
  mutable Mutex mutex_;                                                  ///< protects the member below
  std::map<std::uint64_t, std::string> owner_ SEGUE_GUARDED_BY(mutex_);  ///< as identity_of() names it
};

}  // namespace segue::control::detail
