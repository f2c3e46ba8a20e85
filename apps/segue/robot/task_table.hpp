// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <cstddef>
#include <functional>
#include <string>

namespace segue::cli {

/// The tasks of a status, one per line: state, times, missed cycles, and on request the processor time.
std::string task_table(const type::Value& status, bool with_cpu);

/// The times of tasks as a table of at most so many columns; processes and components where there is room.
std::string use_table(const type::Value::List& tasks, std::size_t columns,
                      const std::function<std::string(const std::string& task)>& processor_share);

}  // namespace segue::cli
