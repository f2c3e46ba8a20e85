// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/hosts/host_service.hpp>

#include <filesystem>
#include <functional>
#include <memory>

namespace segue::control {

/// The daemon of a computer (`segue host`) on the other end of a socket. Calls after it went answer
/// Unavailable; those that it does not answer in time, DeadlineExceeded. `gone` as for connect_deployment();
/// robots that were acquired keep the connection.
Result<std::unique_ptr<hosts::HostService>> connect_host(const std::filesystem::path& socket,
                                                         TimePoint deadline, std::function<void()> gone);

}  // namespace segue::control
