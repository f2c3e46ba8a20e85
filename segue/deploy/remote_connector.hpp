// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/fleet.hpp>
#include <segue/deploy/peer_mapping.hpp>
#include <segue/model/network.hpp>

#include <condition_variable>
#include <mutex>
#include <span>
#include <vector>

namespace segue::deploy::detail {

/// A connection between processes, by plain ids, and who they are. To be taken off, one of them may be null:
/// gone.
struct RemoteConnection {
  model::Connection connection;
  RecordPtr writer;
  RecordPtr reader;
};

/// Lays connections between processes and takes them off, many in a few rounds of messages. One batch at a
/// time: what is half laid must not look like something left over. Thread safe.
class RemoteConnector {
 public:
  explicit RemoteConnector(Fleet& fleet) : fleet_(fleet) {}

  /// What of later connections can be done ahead. Failures are found again when they are laid.
  void map_peers(const std::vector<ProcessPair>& pairs, TimePoint deadline);
  /// Processes that do not know each other yet get to know each other; then three rounds: outputs are
  /// described, inputs opened, outputs attached. An input whose output fails is closed again.
  std::vector<Result<void>> connect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// The writer's endpoints, then the readers'. NotFound where neither was there.
  std::vector<Result<void>> disconnect(std::span<const RemoteConnection> connections, TimePoint deadline);
  /// Takes off endpoints whose counterparts are gone. Does nothing while a batch is under way beyond
  /// `deadline`.
  void remove_orphaned(TimePoint deadline);

 private:
  /// Whose turn it is; waits for the one before, until a deadline.
  class Turn {
   public:
    Turn(RemoteConnector& connector, TimePoint deadline);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    explicit operator bool() const { return mine_; }

   private:
    RemoteConnector& connector_;
    bool mine_ = false;
  };

  void close_orphaned(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline);
  void remove_blocking_endpoints(std::span<const RemoteConnection> connections,
                                 const std::vector<Result<void>>& outcomes, TimePoint deadline);

  Fleet& fleet_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool taken_ = false;
};

}  // namespace segue::deploy::detail
