// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/deploy/deployment_service.hpp>
#include <segue/sample_link/shared_connection.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace segue::deploy::detail {

/// One endpoint of a connection between processes. While a transition moves a task, a connection may lead to
/// both of its incarnations, which are two peers.
struct Endpoint {
  model::Connection connection;
  Side side = Side::Output;
  sample_link::InputPlace place;
  sample_link::Incarnation peer = 0;
  std::shared_ptr<sample_link::SharedEndpoint> shared;

  [[nodiscard]] bool connected() const { return shared->connected(); }
};

/// The endpoints of a process. An endpoint that ended, since its port or its peer is gone, counts as absent.
/// An input that ended stays in the table nevertheless: its ring may be released only after the writer has
/// certainly stopped writing there. Thread safe: one mutex protects the table.
class EndpointTable {
 public:
  /// The connected endpoint to that peer.
  [[nodiscard]] std::optional<Endpoint> find(const model::Connection& connection, Side side,
                                             sample_link::Incarnation peer) const;
  /// Adds an endpoint. AlreadyExists, without a change, where both it and another one to the same peer are
  /// connected. Forgets outputs that ended.
  Result<void> add(Endpoint endpoint);
  /// Removes and returns endpoints, connected or ended: those of a connection to a peer, all of a peer, or
  /// all.
  std::vector<Endpoint> take(const model::Connection& connection, Side side, sample_link::Incarnation peer);
  std::vector<Endpoint> take_of_peer(sample_link::Incarnation peer);
  std::vector<Endpoint> take_all();
  /// All connected endpoints. Forgets outputs that ended.
  [[nodiscard]] std::vector<Endpoint> connected();

 private:
  struct Key {
    model::Connection connection;
    Side side;
    sample_link::Incarnation peer;
  };
  struct ByIdentity {
    bool operator()(const Key& a, const Key& b) const;
  };

  mutable Mutex mutex_;
  std::multimap<Key, Endpoint, ByIdentity> endpoints_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::deploy::detail
