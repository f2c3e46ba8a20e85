// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/connection_claims.hpp>
#include <segue/deploy/fleet.hpp>
#include <segue/deploy/peer_mapping.hpp>
#include <segue/model/network.hpp>

#include <span>
#include <vector>

namespace segue::deploy::detail {

/// A connection between two processes, with plain task ids. When it is to be disconnected, a process that has
/// ended may be null.
struct RemoteConnection {
  model::Connection connection;
  RecordPtr writer;
  RecordPtr reader;
};

/// Connects and disconnects tasks of different processes, many connections in a few rounds of messages. Each
/// batch claims its connections, since remove_orphaned() would take the first endpoint of one that is just
/// being made for an orphan; batches with other connections go on beside it. Thread safe; functions block
/// until their deadline at most.
class RemoteConnector {
 public:
  explicit RemoteConnector(Fleet& fleet) : fleet_(fleet) {}

  /// Makes processes map each other's memory ahead of connecting them. Failures are ignored: connect() tries
  /// again.
  void map_peers(const std::vector<ProcessPair>& pairs, TimePoint deadline);
  /// Makes processes map each other's memory where they have not yet, then connects in three rounds: outputs
  /// are described, inputs opened, outputs attached. An input whose output fails is closed again. Endpoints
  /// that a dead process left in the way are removed first.
  std::vector<Result<void>> connect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// Closes the writers' endpoints, then the readers'. NotFound where neither existed.
  std::vector<Result<void>> disconnect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// Closes endpoints whose counterparts are gone, but none of a connection that is just being worked on.
  void remove_orphaned(TimePoint deadline);

 private:
  void close_orphaned(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline);
  void remove_blocking_endpoints(std::span<const RemoteConnection> connections,
                                 const std::vector<Result<void>>& outcomes, TimePoint deadline);

  Fleet& fleet_;
  ConnectionClaims claims_;
};

}  // namespace segue::deploy::detail
