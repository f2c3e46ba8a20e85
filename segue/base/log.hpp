// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace segue {

enum class LogLevel { Debug, Info, Warning, Error };

std::string_view to_string(LogLevel level);

/// Writes one line for people, to standard error unless another sink is set. Thread safe; blocks, so it must
/// not be called on an update path (use Component::log there, which writes to a preallocated ring).
void log(LogLevel level, std::string_view source, std::string_view message);

/// Sets the level below which lines are dropped. Default: Info.
void set_log_level(LogLevel level);

/// Sets where lines go; an empty function restores standard error. The sink is called under a lock.
using LogSink = std::function<void(LogLevel level, std::string_view source, std::string_view message)>;
void set_log_sink(LogSink sink);

}  // namespace segue
