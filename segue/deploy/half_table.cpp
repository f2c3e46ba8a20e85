// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/half_table.hpp>

#include <tuple>

namespace segue::deploy::detail {

bool HalfTable::ByIdentity::operator()(const Key& a, const Key& b) const {
  return std::tie(a.connection.from, a.connection.to, a.connection.policy, a.side, a.peer) <
         std::tie(b.connection.from, b.connection.to, b.connection.policy, b.side, b.peer);
}

std::optional<Half> HalfTable::find(const model::Connection& connection, Side side,
                                    link::Incarnation peer) const {
  const std::lock_guard lock(mutex_);
  auto [begin, end] = halves_.equal_range({connection, side, peer});
  for (; begin != end; ++begin) {
    if (begin->second.stands()) {
      return begin->second;
    }
  }
  return std::nullopt;
}

Result<void> HalfTable::add(Half half) {
  const std::lock_guard lock(mutex_);
  Key key{half.connection, half.side, half.peer};
  const bool stands = half.stands();
  auto [begin, end] = halves_.equal_range(key);
  while (begin != end) {
    if (stands && begin->second.stands()) {
      return fail(ErrorCode::AlreadyExists, "is already connected", to_string(half.connection));
    }
    begin = half.side == Side::Output ? halves_.erase(begin) : std::next(begin);
  }
  halves_.emplace(std::move(key), std::move(half));
  return {};
}

std::vector<Half> HalfTable::take(const model::Connection& connection, Side side, link::Incarnation peer) {
  const std::lock_guard lock(mutex_);
  std::vector<Half> taken;
  const auto [begin, end] = halves_.equal_range({connection, side, peer});
  for (auto place = begin; place != end; ++place) {
    taken.push_back(std::move(place->second));
  }
  halves_.erase(begin, end);
  return taken;
}

std::vector<Half> HalfTable::take_of_peer(link::Incarnation peer) {
  const std::lock_guard lock(mutex_);
  std::vector<Half> taken;
  for (auto place = halves_.begin(); place != halves_.end();) {
    if (place->second.peer != peer) {
      ++place;
      continue;
    }
    taken.push_back(std::move(place->second));
    place = halves_.erase(place);
  }
  return taken;
}

std::vector<Half> HalfTable::take_all() {
  const std::lock_guard lock(mutex_);
  std::vector<Half> taken;
  for (auto& [key, half] : halves_) {
    taken.push_back(std::move(half));
  }
  halves_.clear();
  return taken;
}

std::vector<Half> HalfTable::standing() {
  const std::lock_guard lock(mutex_);
  std::vector<Half> standing;
  for (auto place = halves_.begin(); place != halves_.end();) {
    const Half& half = place->second;
    const bool stands = half.stands();
    if (stands) {
      standing.push_back(half);
    }
    place = stands || half.side == Side::Input ? std::next(place) : halves_.erase(place);
  }
  return standing;
}

}  // namespace segue::deploy::detail
