// SPDX-License-Identifier: Apache-2.0
#include "own_addresses.hpp"

#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>

namespace ros2 {
namespace {

constexpr std::chrono::seconds kKept{10};
/// Of others; more are forgotten, since anybody may send from any address.
constexpr std::size_t kMostKnown = 1000;
constexpr std::uint8_t kLoopback = 127;

}  // namespace

bool is_own_address(const Ipv4Address& address) {
  if (address.front() == kLoopback) return true;
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in own{};
    std::memcpy(&own, each->ifa_addr, sizeof own);
    if (std::memcmp(&own.sin_addr, address.data(), address.size()) == 0) return true;
  }
  return false;
}

bool OwnAddresses::contains(const Ipv4Address& address) {
  if (address.front() == kLoopback) return true;
  const segue::TimePoint now = segue::monotonic_now();
  const segue::Lock lock(mutex_);
  if (known_.size() > kMostKnown) known_.clear();
  Answer& answer = known_[address];
  if (now >= answer.asked_again) answer = {is_own_address(address), now + kKept};
  return answer.is_own;
}

}  // namespace ros2
