// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/process/process_service.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// What a process server knows of its processes. Internal.
namespace segue::process::detail {

/// A process from before it is started until its end has been dealt with.
struct ProcessEntry {
  std::uint64_t id = 0;
  ProcessInfo info;
  std::string software;          ///< its version; empty where it is not known yet
  Descriptor pidfd;              ///< not valid while it is starting
  bool starting = false;         ///< only its name is taken yet
  bool zygote = false;           ///< a child of the zygote
  std::filesystem::path cgroup;  ///< empty: none
  bool stop_requested = false;
  bool killed = false;
};

/// Entries by number and by name. Not thread safe.
class ProcessTable {
 public:
  using Entry = std::shared_ptr<ProcessEntry>;

  /// Adds one; its name must be free.
  Entry add(ProcessInfo info);
  void remove(const ProcessEntry& entry);
  [[nodiscard]] Entry find(const std::string& robot, const model::DeploymentKey& key) const;
  [[nodiscard]] Entry find(std::uint64_t id) const;
  [[nodiscard]] std::vector<Entry> of(const std::string& robot) const;

 private:
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, Entry> by_id_;
  std::map<std::pair<std::string, model::DeploymentKey>, Entry> by_name_;
};

/// Kills the whole process group that `pid` leads; whoever calls has made sure that it still leads it.
void kill_group(int pid);

/// Takes the exit status of a child that has ended, which then is no process any more. `known` is false where
/// it is no child of this process.
ExitReason reap(int pidfd);
/// Waits for a child that was killed.
void reap_child(int pid);

}  // namespace segue::process::detail
