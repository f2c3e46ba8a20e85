// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployment_service.hpp>
#include <segue/link/shared_connection.hpp>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace segue::deploy::detail {

/// One endpoint of a connection between processes. While a task moves, a connection may lead to both
/// incarnations of it, which are two peers.
struct Endpoint {
  model::Connection connection;
  Side side = Side::Output;
  link::InputPlace place;
  link::Incarnation peer = 0;
  std::shared_ptr<link::SharedEndpoint> shared;

  [[nodiscard]] bool stands() const { return shared->connected(); }
};

/// The endpoints of a process. One that ended (it was closed, its port or its peer is gone) counts as absent;
/// inputs are kept even so, since their places must be released once the writer's end is confirmed. Thread
/// safe.
class EndpointTable {
 public:
  /// The endpoint to that peer that stands.
  [[nodiscard]] std::optional<Endpoint> find(const model::Connection& connection, Side side,
                                             link::Incarnation peer) const;
  /// AlreadyExists, and nothing is changed, where this one and another to the same peer stand. Outputs that
  /// ended are forgotten.
  Result<void> add(Endpoint endpoint);
  /// Out of the table: the endpoints of a connection to a peer that stand or ended, all of a peer, all.
  std::vector<Endpoint> take(const model::Connection& connection, Side side, link::Incarnation peer);
  std::vector<Endpoint> take_of_peer(link::Incarnation peer);
  std::vector<Endpoint> take_all();
  /// Those that stand. Outputs that ended are forgotten.
  [[nodiscard]] std::vector<Endpoint> standing();

 private:
  struct Key {
    model::Connection connection;
    Side side;
    link::Incarnation peer;
  };
  struct ByIdentity {
    bool operator()(const Key& a, const Key& b) const;
  };

  mutable std::mutex mutex_;
  std::multimap<Key, Endpoint, ByIdentity> endpoints_;
};

}  // namespace segue::deploy::detail
