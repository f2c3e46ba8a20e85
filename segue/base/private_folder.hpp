// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>

namespace segue {

/// Where what runs has its sockets: `$XDG_RUNTIME_DIR/segue`, else `/tmp/segue-UID`. Made with mode 0700 and
/// refused where it belongs to somebody else. Any thread.
Result<std::filesystem::path> runtime_folder();

/// Makes a folder (not its parents) that only this user may enter; one that is there is made private.
/// PermissionDenied where it is somebody else's, a link or no folder.
Result<void> make_private_folder(const std::filesystem::path& folder);

}  // namespace segue
