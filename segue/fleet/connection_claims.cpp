// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/connection_claims.hpp>

#include <algorithm>

namespace segue::fleet::detail {

ConnectionClaims::Claim::Claim(ConnectionClaims& claims, std::vector<Key> keys, TimePoint deadline)
    : claims_(claims), keys_(keys.begin(), keys.end()) {
  Lock lock(claims.mutex_);
  granted_ = claims.released_.wait_until(claims.mutex_, deadline, [&]() SEGUE_REQUIRES(claims.mutex_) {
    return std::none_of(keys_.begin(), keys_.end(), [&](const Key& key) SEGUE_REQUIRES(claims.mutex_) {
      return claims.claimed_.contains(key);
    });
  });
  if (!granted_) {
    keys_.clear();
    return;
  }
  claims.claimed_.insert(keys_.begin(), keys_.end());
  for (Watch* watch : claims.watches_) {
    watch->touched_.insert(keys_.begin(), keys_.end());
  }
}

ConnectionClaims::Claim::Claim(ConnectionClaims& claims, std::vector<Key> keys, const Watch& watch)
    : claims_(claims), granted_(true) {
  const Lock lock(claims.mutex_);
  for (Key& key : keys) {
    if (!watch.touched_.contains(key) && claims.claimed_.insert(key).second) {
      keys_.insert(std::move(key));
    }
  }
}

ConnectionClaims::Claim::~Claim() {
  {
    const Lock lock(claims_.mutex_);
    for (const Key& key : keys_) {
      claims_.claimed_.erase(key);
    }
  }
  claims_.released_.notify_all();
}

ConnectionClaims::Claim::Watch::Watch(ConnectionClaims& claims) : claims_(claims) {
  const Lock lock(claims.mutex_);
  touched_ = claims.claimed_;
  claims.watches_.insert(this);
}

ConnectionClaims::Claim::Watch::~Watch() {
  const Lock lock(claims_.mutex_);
  claims_.watches_.erase(this);
}

}  // namespace segue::fleet::detail
