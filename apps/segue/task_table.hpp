// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// The tasks of a status, one a line: state, times, missed cycles, and the processor time if it is asked for.
std::string task_table(const type::Value& status, bool with_cpu);

}  // namespace segue::cli
