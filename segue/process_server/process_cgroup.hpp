// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// Control groups (version 2) of processes. They end everything that a process has started, even what has
/// left its process group, and limit the memory of all that together. Internal.
namespace segue::process_server::detail {

/// Creates a group below `parent` and moves the process into it, which takes some milliseconds. Empty where
/// the system does not permit it.
std::filesystem::path enter_cgroup(const std::filesystem::path& parent, const std::string& title, int pid,
                                   std::optional<std::uint64_t> memory);
/// Kills all processes in the group. Does nothing where `group` is empty, as below.
void kill_cgroup(const std::filesystem::path& group);
/// Removes a group in which no process is left; any other stays and is used again by the next process of that
/// name.
void remove_cgroup(const std::filesystem::path& group);

}  // namespace segue::process_server::detail
