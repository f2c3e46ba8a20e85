// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/runtime/host_places.hpp>

#include <segue/base/descriptor.hpp>
#include <segue/base/text.hpp>
#include <segue/control/host_client.hpp>

#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

namespace segue::runtime {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kUnixScheme = "unix:";
constexpr std::string_view kTcpScheme = "tcp://";
constexpr const char* kThisComputer = "127.0.0.1";

/// The address of another computer without its port, where samples reach it.
std::string data_address(const model::Host& host) {
  const auto address = control::parse_tcp_address(host.address.substr(kTcpScheme.size()));
  return address ? address->host : std::string();
}

/// The address that this computer has towards another one, of which `address` is a number; empty where there
/// is no way to it. Sends nothing.
std::string own_address_towards(const std::string& address) {
  addrinfo numbers{};
  numbers.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  numbers.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), "7", &numbers, &found) != 0) {
    return {};
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> there(found, &::freeaddrinfo);
  const Descriptor socket(::socket(there->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  std::array<char, NI_MAXHOST> name{};
  const bool known = ::connect(socket.get(), there->ai_addr, there->ai_addrlen) == 0 &&
                     ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
                     ::getnameinfo(reinterpret_cast<const sockaddr*>(&own), size, name.data(), name.size(),
                                   nullptr, 0, NI_NUMERICHOST) == 0;
  return known ? name.data() : std::string();
}

/// The credentials of a robot: of the folder that its host names, else the user's.
Result<control::Credentials> credentials_for(const model::Robot& robot, const model::Host& host) {
  if (!host.credentials.empty()) {
    return control::load_credentials(robot.folder / host.credentials, control::CertificateUse::Person);
  }
  const auto folder = control::credentials_folder();
  return folder ? control::load_credentials(*folder, control::CertificateUse::Person)
                : Result<control::Credentials>(folder.error());
}

/// Credentials are read at each attempt, so that they can be put right while the robot runs.
distributed::ConnectHost connector_of(const model::Robot& robot, const model::Host& host) {
  return [robot, host](TimePoint deadline,
                       std::function<void()> gone) -> Result<std::unique_ptr<distributed::HostService>> {
    const auto endpoint = endpoint_of(robot, host);
    if (!endpoint) {
      return endpoint.error();
    }
    return control::connect_host(*endpoint, deadline, std::move(gone));
  };
}

}  // namespace

Result<control::Endpoint> endpoint_of(const model::Robot& robot, const model::Host& host) {
  if (host.address.starts_with(kUnixScheme)) {
    return control::Endpoint(fs::absolute(robot.folder / host.address.substr(kUnixScheme.size())));
  }
  auto address = control::parse_tcp_address(host.address.substr(kTcpScheme.size()));
  if (!address) {
    return std::move(address.error());
  }
  auto credentials = credentials_for(robot, host);
  if (!credentials) {
    return fail(credentials.error().code, "there are no credentials to reach it; see `segue host enrol`",
                host.name.str())
        .because_of(std::move(credentials.error()));
  }
  return control::Endpoint(
      control::TcpEndpoint{std::move(*address), host.name.str(), std::move(*credentials)});
}

distributed::GatewaySettings gateway_settings(const model::Robot& robot) {
  distributed::GatewaySettings settings;
  settings.robot = robot.name;
  if (const char* domain = std::getenv("ROS_DOMAIN_ID")) {
    settings.domain = std::atoi(domain);
  }
  std::string own;
  std::vector<model::HostName> here{model::kLocalHost};
  bool all_here = true;
  for (const auto& host : robot.hosts) {
    if (host.is_local()) {
      settings.own.push_back(host.name);
      continue;
    }
    if (host.address.starts_with(kUnixScheme)) {
      here.push_back(host.name);  // a Unix socket leads to this computer
      continue;
    }
    settings.addresses.emplace(host.name, data_address(host));
    all_here = false;
    if (own.empty()) {
      own = own_address_towards(data_address(host));
    }
  }
  if (all_here) {
    own = kThisComputer;
  }
  for (const auto& name : here) {
    if (!own.empty()) {
      settings.addresses.emplace(name, own);
    }
  }
  return settings;
}

std::vector<std::string> peer_addresses(const model::Robot& robot) {
  std::set<std::string> all;
  for (const auto& [host, address] : gateway_settings(robot).addresses) {
    if (!address.empty()) {
      all.insert(address);
    }
  }
  return {all.begin(), all.end()};
}

std::vector<distributed::HostPlace> host_places(const model::Robot& robot) {
  std::vector<distributed::HostPlace> all;
  for (const auto& host : robot.hosts) {
    if (!host.is_local()) {
      all.push_back({host.name, host.address, host.optional, connector_of(robot, host)});
    }
  }
  return all;
}

bool has_other_hosts(const model::Robot& robot) {
  return std::any_of(robot.hosts.begin(), robot.hosts.end(),
                     [](const model::Host& host) { return !host.is_local(); });
}

}  // namespace segue::runtime
