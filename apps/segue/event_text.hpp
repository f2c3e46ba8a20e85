// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// One event as a line: number, time of day, kind, subject, message.
std::string event_line(const type::Value& event);

}  // namespace segue::cli
