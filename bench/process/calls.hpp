// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <optional>

namespace bench {

/// A call without arguments of an object in another process, through omniORB over a Unix socket; nothing
/// if it was not available at build time, or failed. To be called while this process has no threads.
std::optional<Summary> omniorb_calls(std::size_t repeat);
bool has_omniorb();

/// A byte there and back over a Unix socket.
std::optional<Summary> byte_there_and_back(std::size_t repeat);

/// From posix_spawn of a small program (/bin/true) to its end.
Summary bare_spawn(std::size_t repeat);

}  // namespace bench
