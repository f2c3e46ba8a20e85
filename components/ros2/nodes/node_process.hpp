// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ros2 {

/// A program of ROS 2 and what it is given.
struct NodeProgram {
  std::filesystem::path program;
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> environment;  ///< beside that of this process
  std::string
      parameters;  ///< the text of a parameter file, which the program gets by --params-file; or empty
};

/// A program of ROS 2 that this process has started. It ends with this process, however that ends, and
/// whatever it has started ends with it. What it prints is in the log of this process. Any thread.
class NodeProcess {
 public:
  /// NotFound: it cannot be executed.
  static segue::Result<std::unique_ptr<NodeProcess>> start(const NodeProgram& program);
  /// Kills it where it has not ended.
  ~NodeProcess();
  NodeProcess(const NodeProcess&) = delete;
  NodeProcess& operator=(const NodeProcess&) = delete;

  /// "was killed by signal 11 (Segmentation fault)", "ended with exit status 1"; empty while it runs.
  [[nodiscard]] std::string end() const;
  /// Asks it to end, by SIGINT, then SIGTERM, and kills it; waits until it has ended, but not beyond the
  /// deadline (DeadlineExceeded), at which all of it is killed.
  segue::Result<void> finish(segue::TimePoint deadline);
  /// `ended` is called when it has ended, for whatever reason, in a thread of its own, until `owner` is told
  /// to stop; at once where it has ended before. It must not call this object.
  void watch(const void* owner, std::function<void()> ended);
  /// No call is made any more once it returns.
  void stop_watching(const void* owner);
  /// Can be read from when it has ended.
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }

 private:
  NodeProcess(pid_t guard, segue::Descriptor descriptor, segue::Descriptor owner);
  void wait();

  const pid_t guard_;
  const segue::Descriptor descriptor_;  ///< of the guard's process
  segue::Descriptor owner_;             ///< the program is to end when this is closed
  mutable segue::Mutex mutex_;
  std::string end_ SEGUE_GUARDED_BY(mutex_);
  std::map<const void*, std::function<void()>> watchers_ SEGUE_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace ros2
