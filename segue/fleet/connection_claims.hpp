// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/network.hpp>

#include <set>
#include <span>
#include <utility>
#include <vector>

namespace segue::fleet::detail {

/// Which connections between processes are being worked on. Whoever makes, ends or tidies up a connection
/// claims it first, so that nobody takes a half-made connection for a broken one, and a process that does not
/// answer holds up its own connections only. Thread safe.
class ConnectionClaims {
 public:
  /// Output and input port, with plain task ids.
  using Key = std::pair<model::PortRef, model::PortRef>;

  /// Claims until destroyed. All or none.
  class Claim {
   public:
    /// Waits until none of the connections is claimed by another, until `deadline` at most.
    Claim(ConnectionClaims& claims, std::vector<Key> keys, TimePoint deadline);
    /// Claims those that are neither claimed now nor were at any time since `watch` began. Does not wait.
    class Watch;
    Claim(ConnectionClaims& claims, std::vector<Key> keys, const Watch& watch);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    /// False: the deadline has passed, and nothing is claimed.
    explicit operator bool() const { return granted_; }
    [[nodiscard]] bool has(const Key& key) const { return keys_.contains(key); }

   private:
    ConnectionClaims& claims_;
    std::set<Key> keys_;
    bool granted_ = false;
  };

 private:
  Mutex mutex_;  ///< protects all below
  ConditionVariable released_;
  std::set<Key> claimed_ SEGUE_GUARDED_BY(mutex_);
  std::set<Claim::Watch*> watches_ SEGUE_GUARDED_BY(mutex_);
};

/// Notes which connections are claimed while it lives, those that were claimed already included.
class ConnectionClaims::Claim::Watch {
 public:
  explicit Watch(ConnectionClaims& claims);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  friend class ConnectionClaims::Claim;
  ConnectionClaims& claims_;
  std::set<Key> touched_;  ///< protected by the mutex of the claims
};

}  // namespace segue::fleet::detail
