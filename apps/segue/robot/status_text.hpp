// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

/// Parts of a status as lines for people; each ends with a line end, and is empty where there is nothing to
/// say.
namespace segue::cli {

/// Of the robot as a whole: its loss, troubles, halt, commander, other controllers, changed files, pools and
/// hosts.
std::string state_lines(const type::Value& status);
/// Connections of a status, with their counts and latencies.
std::string connections_table(const type::Value::List& connections);
/// Drift, processes that ended, and faults that were not resolved.
std::string faults_text(const type::Value& status);

}  // namespace segue::cli
