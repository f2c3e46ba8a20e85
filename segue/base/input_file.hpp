// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <string>

namespace segue {

/// The environment variable with the largest size of input files, as parse_size() reads it. Default: 16MiB.
inline constexpr const char* kLargestInput = "SEGUE_MAX_FILE_SIZE";

/// read_file() for YAML and JSON, whose parsing takes many times a file's size: ResourceExhausted, with a
/// message that names kLargestInput, where the file is larger.
Result<std::string> read_input_file(const std::filesystem::path& path);

}  // namespace segue
