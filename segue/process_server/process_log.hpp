// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

/// Log files with the output of deployment processes. Each process writes and rotates its own, so logging
/// does not depend on the process server.
namespace segue::process_server {

/// Opens a log for appending and creates it with mode 0600 if need be. Fails for symbolic links.
Result<Descriptor> open_log(const std::filesystem::path& log);

/// The descriptor with which an OutputLog watches its log. Whoever starts a process makes it, hands it over
/// and keeps a duplicate: the system takes up to some 20 ms to close the last one, which would delay the end
/// of the process. Where the system cannot watch any more files, it never becomes readable. ResourceExhausted
/// where there is no descriptor left.
Result<Descriptor> open_output_changes();

/// The log of the process whose standard output and error it is: once the file has grown beyond `size` bytes,
/// it is renamed to `log`.1, that one to .2 and so on up to `files`, and the output goes on in a new file.
/// Not thread safe.
class OutputLog {
 public:
  /// `changes` is what open_output_changes() has made; it may be invalid.
  OutputLog(std::filesystem::path log, std::size_t size, int files, Descriptor changes);
  /// Becomes readable when there is output, so that a log is not seen to be too large only now and then; -1
  /// where nothing tells.
  [[nodiscard]] int changes() const { return changes_.get(); }
  /// Renames the files and begins a new one; where that fails, the output stays in the old one. Afterwards
  /// `changes` waits for further output.
  void rotate();

 private:
  void watch();
  [[nodiscard]] bool is_too_large() const;
  void begin_new_file() const;

  const std::filesystem::path log_;
  const std::size_t size_;
  const int files_;
  Descriptor changes_;
};

/// A place in the output of a process, which stays valid when its log is rotated.
struct LogPosition {
  std::uint64_t file = 0;  ///< inode
  std::uint64_t offset = 0;
  friend bool operator==(const LogPosition&, const LogPosition&) = default;
};

/// A part of the output of a process.
struct LogPart {
  std::string text;
  LogPosition end;  ///< where it goes on
};

/// The last `lines` lines of a log, from its older files too, but never more than `most` bytes. NotFound
/// where there is no log.
Result<LogPart> log_tail(const std::filesystem::path& log, std::size_t lines,
                         std::size_t most = std::size_t{16} << 20);

/// The output after `position`, at most 64 KiB of it; empty where there is nothing yet. Goes on in the newer
/// file where the log was rotated, and at the begin of the newest one where the file of `position` is gone.
/// NotFound where there is no log.
Result<LogPart> log_after(const std::filesystem::path& log, const LogPosition& position);

}  // namespace segue::process_server
