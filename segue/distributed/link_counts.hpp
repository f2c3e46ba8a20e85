// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace segue::distributed::detail {

/// Counts of samples of connections between hosts, from those of their halves. Samples that a sender has
/// taken since the receiver was first seen, and that no receiver has delivered, count as dropped, though some
/// may be on their way. Latencies of the halves add up, without the way between the hosts. The counts outlive
/// a time in which the host of a half is lost, and a half that is made anew. Not thread safe.
class LinkCounts {
 public:
  /// Notes one look at the connections. To be called in turn with each look, so that new connections are seen
  /// early. Where the look is not `complete`, because a host is lost, connections that are not seen are not
  /// forgotten.
  void note(const std::vector<task_host::ConnectionReport>& reports, bool complete);
  /// Replaces the halves by whole connections, as without_gateways() does.
  [[nodiscard]] std::vector<task_host::ConnectionReport> condense(
      std::vector<task_host::ConnectionReport> reports) const;

 private:
  using Key = std::pair<model::PortRef, model::PortRef>;
  struct Seen {
    std::uint64_t taken = 0;      ///< by the sender
    std::uint64_t delivered = 0;  ///< by the receiver
    /// The number of samples that the sender has taken beyond those delivered and that the receiver owes
    /// nobody: those before the receiver existed. Samples that halves counted before they were made anew are
    /// part of it.
    std::int64_t not_owed = 0;
  };
  std::map<Key, Seen> seen_;
};

}  // namespace segue::distributed::detail
