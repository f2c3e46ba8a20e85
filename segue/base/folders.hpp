// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <vector>

namespace segue {

/// The folder for the sockets of running processes: `$XDG_RUNTIME_DIR/segue`, else `/tmp/segue-UID`. Created
/// with mode 0700; PermissionDenied where it belongs to somebody else. Any thread.
Result<std::filesystem::path> runtime_folder();

/// The folder for the user's configuration: `$XDG_CONFIG_HOME/segue`, for root `/etc/segue`, else
/// `~/.config/segue`. It need not exist. InvalidState where neither variable is an absolute path. Any thread.
Result<std::filesystem::path> configuration_folder();

/// Creates a folder (not its parents) that only this user may enter; an existing one is made private.
/// PermissionDenied where it belongs to somebody else, is a link or is not a folder.
Result<void> make_private_folder(const std::filesystem::path& folder);

/// Where Segue may be installed or built: the prefixes of this program and of its libraries (<prefix>/lib,
/// <prefix>/lib/<architecture>), the most likely first. Any thread.
std::vector<std::filesystem::path> install_prefixes();

}  // namespace segue
