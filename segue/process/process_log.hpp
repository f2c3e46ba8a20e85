// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

/// What a deployment process prints, in files. It writes them itself, so they outlive its process server.
namespace segue::process {

/// Opens the file to append to, made with mode 0600; nothing is followed that is not a file of its own.
Result<Descriptor> open_log(const std::filesystem::path& log);

/// In the process whose standard output and error are `log`: where that has grown beyond `size` bytes, the
/// file becomes `log`.1, that one .2 and so on up to `files`, and output goes on in a new one. Where the
/// system lets it do no such thing, output goes on where it was. Not thread safe.
void rotate_output(const std::filesystem::path& log, std::size_t size, int files);

/// The last `lines` lines of the log, older files included, without looking at more than `most` bytes.
/// NotFound where the process has never printed.
Result<std::string> log_tail(const std::filesystem::path& log, std::size_t lines,
                             std::size_t most = std::size_t{16} << 20);

/// Follows a log as it is written and rotated. Not thread safe.
class LogFollower {
 public:
  /// Begins at the end of what is there.
  explicit LogFollower(std::filesystem::path log);
  /// What was added since the last call; empty where nothing was. Does not block.
  std::string read();

 private:
  std::filesystem::path log_;
  Descriptor file_;
};

}  // namespace segue::process
