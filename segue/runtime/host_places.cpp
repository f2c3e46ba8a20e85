// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/host_places.hpp>

#include <segue/base/text.hpp>
#include <segue/control/host_client.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <utility>

namespace segue::runtime {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kUnixScheme = "unix:";
constexpr std::string_view kTcpScheme = "tcp://";

/// The address of a host without its port, where samples reach it.
std::string data_address(const model::Host& host) {
  if (!host.address.starts_with(kTcpScheme)) {
    return "127.0.0.1";  // a Unix socket leads to this computer
  }
  const auto address = control::parse_tcp_address(host.address.substr(kTcpScheme.size()));
  return address ? address->host : std::string();
}

/// The credentials of a robot: of the folder that its host names, else the user's.
Result<control::Credentials> credentials_for(const model::Robot& robot, const model::Host& host) {
  if (!host.credentials.empty()) {
    return control::Credentials::load(robot.folder / host.credentials, control::Credentials::Use::Person);
  }
  const auto folder = control::credentials_folder();
  return folder ? control::Credentials::load(*folder, control::Credentials::Use::Person)
                : Result<control::Credentials>(folder.error());
}

/// Credentials are read at each attempt, so that they can be put right while the robot runs.
hosts::ConnectHost connector_of(const model::Robot& robot, const model::Host& host) {
  return [robot, host](TimePoint deadline,
                       std::function<void()> gone) -> Result<std::unique_ptr<hosts::HostService>> {
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

hosts::GatewaySettings gateway_settings(const model::Robot& robot) {
  hosts::GatewaySettings settings;
  settings.robot = robot.name;
  if (const char* domain = std::getenv("ROS_DOMAIN_ID")) {
    settings.domain = std::atoi(domain);
  }
  bool all_here = true;
  for (const auto& host : robot.hosts) {
    if (host.is_local()) {
      settings.own.push_back(host.name);
    } else {
      settings.addresses.emplace(host.name, data_address(host));
      all_here = all_here && host.address.starts_with(kUnixScheme);
    }
  }
  if (all_here) {
    settings.addresses.emplace(model::kLocalHost, "127.0.0.1");
  }
  return settings;
}

std::vector<hosts::HostPlace> host_places(const model::Robot& robot) {
  std::vector<hosts::HostPlace> all;
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
