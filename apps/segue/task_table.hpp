// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// The tasks of a status, one per line: state, times, missed cycles, and on request the processor time.
std::string task_table(const type::Value& status, bool with_cpu);

}  // namespace segue::cli
