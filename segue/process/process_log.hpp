// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

/// Log files with the output of deployment processes. Each process writes and rotates its own, so logging
/// does not depend on the process server.
namespace segue::process {

/// Opens a log for appending and creates it with mode 0600 if need be. Fails for symbolic links.
Result<Descriptor> open_log(const std::filesystem::path& log);

/// To be called in the process whose standard output and error are `log`: if the file has grown beyond `size`
/// bytes, it is renamed to `log`.1, that one to .2 and so on up to `files`, and the output goes on in a new
/// file. Where renaming fails, the output stays where it is. Not thread safe.
void rotate_output(const std::filesystem::path& log, std::size_t size, int files);

/// The last `lines` lines of a log, from its older files too, but never more than `most` bytes. NotFound
/// where there is no log.
Result<std::string> log_tail(const std::filesystem::path& log, std::size_t lines,
                             std::size_t most = std::size_t{16} << 20);

/// Follows a log while it is written and rotated. Not thread safe.
class LogFollower {
 public:
  /// Begins at the present end of the log.
  explicit LogFollower(std::filesystem::path log);
  /// The output since the last call, at most 64 KiB of it; empty where there is none. Does not block.
  std::string read();

 private:
  std::filesystem::path log_;
  Descriptor file_;
};

}  // namespace segue::process
