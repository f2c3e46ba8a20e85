// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/fleet/connection_batch.hpp>
#include <segue/fleet/connection_claims.hpp>
#include <segue/fleet/damage_log.hpp>
#include <segue/fleet/fleet.hpp>
#include <segue/fleet/peer_mapping.hpp>
#include <segue/model/network.hpp>

#include <map>
#include <set>
#include <span>
#include <vector>

namespace segue::fleet::detail {

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
  /// Connects in as few messages as possible (connect_all()). Endpoints that a dead process left in the way
  /// are removed first.
  std::vector<Result<void>> connect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// Closes the writers' endpoints, then the readers' (disconnect_all()).
  std::vector<Result<void>> disconnect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// Closes endpoints whose counterparts are gone and dormant ones, but none of a connection that is just
  /// being worked on or that waits for the commit of the present transition.
  void remove_orphaned(TimePoint deadline);
  /// Reports the connections that were ended because their memory was overwritten, those in `seen` included,
  /// and that are missing since.
  std::vector<task_host::ConnectionReport> note_damage(const MergedView& seen);
  /// The connection ends with the commit of the present transition, which disconnects it afterwards.
  void will_end(const model::Connection& connection);
  /// settle(): the transition has committed, so no connection waits for it any more. give_up(): it was given
  /// up, so connections that would have begun are removed. conclude(): it is over, so connections that ended
  /// with it and still exist are orphans.
  void settle();
  void give_up(TimePoint deadline);
  void conclude();

 private:
  void close_orphaned(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline);
  void remove_blocking_endpoints(std::span<const RemoteConnection> connections,
                                 const std::vector<Result<void>>& outcomes, TimePoint deadline);

  void forget_ending();
  using Waiting = std::map<ConnectionClaims::Key, RemoteConnection>;
  void add_waiting(std::span<const RemoteConnection> connections);
  [[nodiscard]] std::set<ConnectionClaims::Key> in_transition() const;
  Waiting take_waiting();

  Fleet& fleet_;
  ConnectionClaims claims_;
  DamageLog damage_;
  mutable Mutex mutex_;
  Waiting waiting_ SEGUE_GUARDED_BY(mutex_);  ///< connections that begin with the commit; protected by mutex_
  std::set<ConnectionClaims::Key> ending_ SEGUE_GUARDED_BY(mutex_);  ///< connections that end with it
};

}  // namespace segue::fleet::detail
