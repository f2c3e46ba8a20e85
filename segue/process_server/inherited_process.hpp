// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>

#include <filesystem>
#include <string_view>

namespace segue::process_server {

/// The deployment process's own side: the descriptors that it inherits (assignment.hpp) and the signals that
/// ask it to end. One for each process, to be created before there is a second thread. Not thread safe.
class InheritedProcess {
 public:
  /// Takes the inherited descriptors and makes them close-on-exec, blocks SIGTERM and SIGINT for all threads,
  /// ignores SIGPIPE, SIGHUP and SIGXFSZ, and makes standard output line-buffered.
  InheritedProcess();

  /// Writes pid and version into the lock file, by which other servers find this process, and a first line
  /// into the log. Closes the assignment.
  void begin(const std::filesystem::path& socket, std::string_view software);
  /// The listening socket; may be called once.
  Descriptor take_listener() { return std::move(listener_); }
  /// The descriptor that tells when the log has grown, for OutputLog; may be called once.
  Descriptor take_output_changes() { return std::move(output_changes_); }
  /// Waits for at most `most`, or until the descriptor is readable (-1: none); true where the process has
  /// been asked to end.
  bool wait_for_end(Duration most, int readable = -1);
  /// Removes socket and lock, so that nobody finds this process any more.
  void leave();

 private:
  Descriptor listener_;
  Descriptor lock_;
  Descriptor output_changes_;
  Descriptor signals_;  ///< that ask it to end
  std::filesystem::path socket_;
};

}  // namespace segue::process_server
