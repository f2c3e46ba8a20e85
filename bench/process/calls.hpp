// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board.hpp"

#include <optional>

namespace bench {

enum class Way { UnixSocket, Tcp };  ///< the latter of this computer with itself

/// A call without arguments of an object in another process, through omniORB; nothing if it was not available
/// at build time, or failed. To be called while this process has no threads.
std::optional<Summary> omniorb_calls(Way way, std::size_t repeat);
bool has_omniorb();

/// A byte there and back. To be called while this process has no threads.
std::optional<Summary> byte_there_and_back(Way way, std::size_t repeat);

/// The time from posix_spawn of a small program (/bin/true) to its end.
Summary bare_spawn(std::size_t repeat);

}  // namespace bench
