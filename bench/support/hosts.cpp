// SPDX-License-Identifier: Apache-2.0
#include "hosts.hpp"

#include <segue/base/text.hpp>
#include <segue/rpc_tls/authority.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdio>
#include <cstdlib>

namespace bench {
namespace {

constexpr const char* kMe = "me";

template <class T>
T required(segue::Result<T> made) {
  if (made) return std::move(*made);
  std::fprintf(stderr, "%s\n", to_string(made.error()).c_str());
  std::exit(1);
}

/// A TCP port that nobody uses now.
int free_port() {
  const segue::Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  if (::bind(socket.get(), generic, size) != 0 || ::getsockname(socket.get(), generic, &size) != 0) {
    std::perror("no port");
    std::exit(1);
  }
  return ntohs(address.sin_port);
}

}  // namespace

Hosts::Hosts(const std::vector<Site>& sites) : sites_(sites) {
  using segue::control::Authority;
  using segue::control::Role;
  auto authority = required(Authority::create(folder_.path() / "authority"));
  required(authority.enrol({kMe, Role::Operate}, keys(kMe)));
  std::vector<segue::runtime::TemporaryHost> wanted;
  for (const Site& site : sites_) {
    required(authority.enrol({site.name, Role::Operate, true}, keys(site.name)));
    ports_.push_back(free_port());
    wanted.push_back({site.name,
                      site.launcher,
                      {"--log-level", "error", "--listen", site.address + ":" + std::to_string(ports_.back()),
                       "--credentials", keys(site.name)}});
  }
  if (const auto started = hosts_.start(wanted, SEGUE_BENCH_PROGRAM); !started) {
    std::fprintf(stderr, "%s\n", to_string(started.error()).c_str());
    std::exit(1);
  }
}

segue::runtime::HostEntries Hosts::over_tcp() const {
  segue::runtime::HostEntries entries;
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    entries.emplace(sites_[i].name, "{address: \"tcp://" + sites_[i].address + ":" +
                                        std::to_string(ports_[i]) + "\", credentials: \"" + keys(kMe) +
                                        "\"}");
  }
  return entries;
}

segue::runtime::HostEntries Hosts::over_unix_sockets() const {
  segue::runtime::HostEntries entries;
  for (const Site& site : sites_)
    entries.emplace(site.name, '"' + hosts_.address(site.name) + '"');
  return entries;
}

}  // namespace bench
