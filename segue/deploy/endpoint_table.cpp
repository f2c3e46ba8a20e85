// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/endpoint_table.hpp>

#include <tuple>

namespace segue::deploy::detail {

bool EndpointTable::ByIdentity::operator()(const Key& a, const Key& b) const {
  return std::tie(a.connection.from, a.connection.to, a.connection.policy, a.side, a.peer) <
         std::tie(b.connection.from, b.connection.to, b.connection.policy, b.side, b.peer);
}

std::optional<Endpoint> EndpointTable::find(const model::Connection& connection, Side side,
                                            sample_link::Incarnation peer) const {
  const Lock lock(mutex_);
  auto [begin, end] = endpoints_.equal_range({connection, side, peer});
  for (; begin != end; ++begin) {
    if (begin->second.connected()) {
      return begin->second;
    }
  }
  return std::nullopt;
}

Result<void> EndpointTable::add(Endpoint endpoint) {
  const Lock lock(mutex_);
  Key key{endpoint.connection, endpoint.side, endpoint.peer};
  const bool is_connected = endpoint.connected();
  auto [begin, end] = endpoints_.equal_range(key);
  while (begin != end) {
    if (is_connected && begin->second.connected()) {
      return fail(ErrorCode::AlreadyExists, "is already connected", to_string(endpoint.connection));
    }
    begin = endpoint.side == Side::Output ? endpoints_.erase(begin) : std::next(begin);
  }
  endpoints_.emplace(std::move(key), std::move(endpoint));
  return {};
}

std::vector<Endpoint> EndpointTable::take(const model::Connection& connection, Side side,
                                          sample_link::Incarnation peer) {
  const Lock lock(mutex_);
  std::vector<Endpoint> taken;
  const auto [begin, end] = endpoints_.equal_range({connection, side, peer});
  for (auto place = begin; place != end; ++place) {
    taken.push_back(std::move(place->second));
  }
  endpoints_.erase(begin, end);
  return taken;
}

std::vector<Endpoint> EndpointTable::take_of_peer(sample_link::Incarnation peer) {
  const Lock lock(mutex_);
  std::vector<Endpoint> taken;
  for (auto place = endpoints_.begin(); place != endpoints_.end();) {
    if (place->second.peer != peer) {
      ++place;
      continue;
    }
    taken.push_back(std::move(place->second));
    place = endpoints_.erase(place);
  }
  return taken;
}

std::vector<Endpoint> EndpointTable::take_all() {
  const Lock lock(mutex_);
  std::vector<Endpoint> taken;
  for (auto& [key, endpoint] : endpoints_) {
    taken.push_back(std::move(endpoint));
  }
  endpoints_.clear();
  return taken;
}

std::vector<Endpoint> EndpointTable::connected() {
  const Lock lock(mutex_);
  std::vector<Endpoint> endpoints;
  for (auto place = endpoints_.begin(); place != endpoints_.end();) {
    const Endpoint& endpoint = place->second;
    const bool is_connected = endpoint.connected();
    if (is_connected) {
      endpoints.push_back(endpoint);
    }
    place = is_connected || endpoint.side == Side::Input ? std::next(place) : endpoints_.erase(place);
  }
  return endpoints;
}

}  // namespace segue::deploy::detail
