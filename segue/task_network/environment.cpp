// SPDX-License-Identifier: Apache-2.0
#include "environment.hpp"

namespace segue::task_network {

// Not inline: most nodes end without a report, and every place that owns one would contain its destruction.
Report::Report() = default;
Report::~Report() = default;

}  // namespace segue::task_network
