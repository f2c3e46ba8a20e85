// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace segue::hosts::detail {

/// Counts of samples of connections between hosts, from those of their halves. What a sender has taken since
/// the receiver was first seen, and what no receiver delivered, counts as dropped, though some of it may be
/// on its way. Not thread safe.
class LinkCounts {
 public:
  /// To be called with each look at the connections, so that those that are new are seen early.
  void note(const std::vector<host::ConnectionReport>& reports);
  /// Replaces the halves by whole connections, as without_gateways() does.
  [[nodiscard]] std::vector<host::ConnectionReport> condense(
      std::vector<host::ConnectionReport> reports) const;

 private:
  using Key = std::pair<model::PortRef, model::PortRef>;
  /// How many samples the sender of a connection had taken before its receiver was there.
  std::map<Key, std::uint64_t> before_;
};

}  // namespace segue::hosts::detail
