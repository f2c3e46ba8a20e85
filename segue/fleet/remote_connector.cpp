// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/remote_connector.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace segue::fleet::detail {

namespace {

bool is_of(const OrphanedEndpoint& endpoint, const RemoteConnection& remote) {
  const bool output = endpoint.side == deploy::Side::Output;
  const RecordPtr& own = output ? remote.writer : remote.reader;
  const RecordPtr& other = output ? remote.reader : remote.writer;
  return endpoint.connection == remote.connection && endpoint.process == own->key() &&
         endpoint.peer == other->incarnation();
}

ConnectionClaims::Key key_of(const model::Connection& connection) {
  return {connection.from, connection.to};
}

std::vector<ConnectionClaims::Key> keys_of(std::span<const RemoteConnection> connections) {
  std::vector<ConnectionClaims::Key> keys;
  for (const auto& remote : connections) {
    keys.push_back(key_of(remote.connection));
  }
  return keys;
}

Error another_batch_runs() {
  return fail(ErrorCode::DeadlineExceeded, "the same connections are still being made or ended");
}

}  // namespace

std::vector<Result<void>> RemoteConnector::connect(std::span<const RemoteConnection> connections,
                                                   TimePoint deadline) {
  const ConnectionClaims::Claim claim(claims_, keys_of(connections), deadline);
  if (!claim) {
    return {connections.size(), another_batch_runs()};
  }
  add_waiting(connections);
  auto outcomes = connect_all(fleet_.pool(), connections, deadline);
  remove_blocking_endpoints(connections, outcomes, deadline);
  std::vector<RemoteConnection> again;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i] && outcomes[i].error().code == ErrorCode::AlreadyExists) {
      again.push_back(connections[i]);
      indices.push_back(i);
    }
  }
  if (!again.empty()) {
    auto second = connect_all(fleet_.pool(), again, deadline);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      outcomes[indices[i]] = std::move(second[i]);
    }
  }
  return outcomes;
}

/// A process that died while it was connected may have left the endpoint of its peer behind, and a transition
/// that was not completed both endpoints of a connection that ended with its commit.
void RemoteConnector::remove_blocking_endpoints(std::span<const RemoteConnection> connections,
                                                const std::vector<Result<void>>& outcomes,
                                                TimePoint deadline) {
  std::vector<RemoteConnection> blocked;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i] && outcomes[i].error().code == ErrorCode::AlreadyExists) {
      blocked.push_back(connections[i]);
    }
  }
  // Where both endpoints exist, the output is the first orphan, and the input becomes one when that is
  // closed.
  for (int round = 0; round < 2 && !blocked.empty(); ++round) {
    auto orphaned = fleet_.poll_merged().orphaned;
    std::erase_if(orphaned, [&](const OrphanedEndpoint& endpoint) {
      return std::none_of(blocked.begin(), blocked.end(),
                          [&](const RemoteConnection& one) { return is_of(endpoint, one); });
    });
    close_orphaned(orphaned, deadline);
  }
}

void RemoteConnector::map_peers(const std::vector<ProcessPair>& pairs, TimePoint deadline) {
  (void)detail::map_peers(fleet_.pool(), pairs, deadline);
}

std::vector<Result<void>> RemoteConnector::disconnect(std::span<const RemoteConnection> connections,
                                                      TimePoint deadline) {
  const ConnectionClaims::Claim claim(claims_, keys_of(connections), deadline);
  if (!claim) {
    return {connections.size(), another_batch_runs()};
  }
  return disconnect_all(fleet_.pool(), connections, deadline);
}

void RemoteConnector::add_waiting(std::span<const RemoteConnection> connections) {
  const Lock lock(mutex_);
  for (const auto& remote : connections) {
    if (remote.at_commit) {
      waiting_.insert_or_assign(key_of(remote.connection), remote);
    }
  }
}

std::set<ConnectionClaims::Key> RemoteConnector::in_transition() const {
  const Lock lock(mutex_);
  std::set<ConnectionClaims::Key> keys = ending_;
  for (const auto& [key, remote] : waiting_) {
    keys.insert(key);
  }
  return keys;
}

void RemoteConnector::will_end(const model::Connection& connection) {
  const Lock lock(mutex_);
  ending_.insert(key_of(connection));
}

void RemoteConnector::conclude() {
  damage_.clear();
  forget_ending();
}

void RemoteConnector::forget_ending() {
  const Lock lock(mutex_);
  ending_.clear();
}

RemoteConnector::Waiting RemoteConnector::take_waiting() {
  const Lock lock(mutex_);
  return std::exchange(waiting_, {});
}

void RemoteConnector::settle() {
  take_waiting();
}

void RemoteConnector::give_up(TimePoint deadline) {
  forget_ending();
  std::vector<RemoteConnection> connections;
  for (auto& [key, remote] : take_waiting()) {
    if (remote.writer->answers() && remote.reader->answers()) {
      connections.push_back(std::move(remote));
    }
  }
  if (!connections.empty()) {
    disconnect(connections, deadline);
  }
  // A connection that cannot be reached now is an orphan later.
}

void RemoteConnector::remove_orphaned(TimePoint deadline) {
  const ConnectionClaims::Claim::Watch watch(claims_);
  const auto kept = in_transition();  // what is added after this is claimed, or carries samples
  MergedView merged = fleet_.poll_merged();
  auto& orphaned = merged.orphaned;
  note_damage(merged);
  std::vector<ConnectionClaims::Key> keys;
  for (const auto& endpoint : orphaned) {
    keys.push_back(key_of(endpoint.connection));
  }
  const ConnectionClaims::Claim claim(claims_, std::move(keys), watch);
  // An endpoint is closed only if nobody else works on it, even where its peer seems to be gone: a peer that
  // was started and connected during the poll is not in its list.
  std::erase_if(orphaned, [&](const OrphanedEndpoint& endpoint) {
    const auto key = key_of(endpoint.connection);
    return !claim.has(key) || kept.contains(key);
  });
  close_orphaned(orphaned, deadline);
}

std::vector<task_host::ConnectionReport> RemoteConnector::note_damage(const MergedView& seen) {
  const auto found = damage_.note(seen, RealClock::instance().now());
  for (const auto& damaged : found.damaged) {
    log(LogLevel::Error, "deploy", to_string(damaged.connection) + " is ended: " + damage_text(damaged));
  }
  for (const auto& [process, why] : found.culprits) {
    fleet_.blame(process, why);
  }
  return damage_.reports();
}

void RemoteConnector::close_orphaned(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline) {
  std::map<model::DeploymentKey, std::vector<const OrphanedEndpoint*>> by_process;
  for (const auto& endpoint : orphaned) {
    by_process[endpoint.process].push_back(&endpoint);
  }
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& [key, endpoints] : by_process) {
    jobs.emplace_back([this, deadline, key = key, &endpoints = endpoints] {
      const auto record = fleet_.find(key);
      const auto service = record ? record->service() : nullptr;
      if (service == nullptr) {
        return;
      }
      std::set<sample_link::Incarnation> dead;
      std::vector<deploy::CloseEndpoint> close;
      for (const OrphanedEndpoint* endpoint : endpoints) {
        endpoint->peer_gone ? void(dead.insert(endpoint->peer))
                            : close.push_back({endpoint->connection, endpoint->side,
                                               endpoint->side == deploy::Side::Input, endpoint->peer});
      }
      for (const auto incarnation : dead) {
        (void)service->forget(incarnation);
        record->mark_unmapped(incarnation);
      }
      if (!close.empty()) {
        (void)service->close_endpoints(close, deadline);  // what fails is seen by the next poll
      }
    });
  }
  fleet_.pool().run_all(std::move(jobs));
}

}  // namespace segue::fleet::detail
