// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>

namespace segue {

/// "WHAT: No such file or directory", with the code that fits the system's reason (an errno). Any thread.
Error system_error(const std::string& what, int reason);

}  // namespace segue
