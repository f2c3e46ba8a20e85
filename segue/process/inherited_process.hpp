// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>

#include <filesystem>
#include <string_view>

namespace segue::process {

/// This process as a deployment process: what it was handed (assignment.hpp) and the signals by which it is
/// told to go. One for each process; make it before there is a second thread. Not thread safe.
class InheritedProcess {
 public:
  /// Takes the inherited descriptors (which no program that is started from here gets); blocks SIGTERM and
  /// SIGINT for all threads, ignores SIGPIPE and SIGHUP. Standard output becomes line-buffered.
  InheritedProcess();

  /// Says in the lock who holds it, and in the log who starts.
  void begin(const std::filesystem::path& socket, std::string_view software);
  /// The listening socket. Once.
  Descriptor take_listener() { return std::move(listener_); }
  /// Whether it was told to go; waits for `most`.
  bool wait_for_end(Duration most);
  /// Removes socket and lock: nobody finds this process any more.
  void leave();

 private:
  Descriptor listener_;
  Descriptor lock_;
  std::filesystem::path socket_;
};

}  // namespace segue::process
