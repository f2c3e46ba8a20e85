// SPDX-License-Identifier: Apache-2.0
#include "static_peers.hpp"

#include <segue/base/text.hpp>

#include <netdb.h>
#include <netinet/in.h>

#include <cstring>
#include <memory>

namespace ros2 {
namespace {

segue::Result<Ipv4Address> address_of_peer(const std::string& peer) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* first = nullptr;
  if (const int failed = ::getaddrinfo(peer.c_str(), nullptr, &hints, &first); failed != 0) {
    return segue::fail(segue::ErrorCode::Unavailable,
                       "static peer " + segue::quote(peer) + " is not known as an IPv4 address or a name (" +
                           ::gai_strerror(failed) + "); name another one, or leave it out");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(first, &::freeaddrinfo);
  sockaddr_in found{};
  std::memcpy(&found, first->ai_addr, sizeof found);
  Ipv4Address address{};
  std::memcpy(address.data(), &found.sin_addr, address.size());
  return address;
}

}  // namespace

segue::Result<std::vector<Ipv4Address>> addresses_of_peers(const std::vector<std::string>& peers) {
  std::vector<Ipv4Address> all;
  for (const std::string& peer : peers) {
    auto one = address_of_peer(peer);
    if (!one) return one.error();
    all.push_back(*one);
  }
  return all;
}

}  // namespace ros2
