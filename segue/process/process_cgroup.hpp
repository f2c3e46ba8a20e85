// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// Control groups (version 2) of processes: what a process has started goes with it, even where it left its
/// process group, and its memory is limited as a whole. Internal.
namespace segue::process::detail {

/// Makes a group under `parent` and puts the process into it. Empty where the system does not let it; then
/// all goes on without. The system takes some milliseconds to move a process.
std::filesystem::path enter_cgroup(const std::filesystem::path& parent, const std::string& title, int pid,
                                   std::optional<std::uint64_t> memory);
/// Kills all that is in it. Nothing where `group` is empty, as below.
void kill_cgroup(const std::filesystem::path& group);
/// Once it is empty; one that is not stays and is used again.
void remove_cgroup(const std::filesystem::path& group);

}  // namespace segue::process::detail
