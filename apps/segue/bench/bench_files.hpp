// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>

namespace segue::cli {

/// The folder of --out, where it does not exist.
Result<void> make_bench_folder(const std::string& folder);

}  // namespace segue::cli
