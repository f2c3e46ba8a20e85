// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/process_server/process_service.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The processes of a process server. Internal.
namespace segue::process_server::detail {

/// A process, from before it is started until its end has been dealt with.
struct ProcessEntry {
  std::uint64_t id = 0;
  ProcessInfo info;
  std::string software;  ///< its version of Segue; empty until it is known
  Descriptor pidfd;      ///< invalid while it is starting
  /// A duplicate of the descriptor that watches its log (open_output_changes()).
  Descriptor output_changes{};
  bool starting = false;         ///< its name is taken, but it is not watched yet
  bool zygote = false;           ///< it is a child of the zygote
  std::filesystem::path cgroup;  ///< empty: none
  bool ending = false;           ///< it has ended; its pid may belong to another process
  bool stop_requested = false;
  bool killed = false;
};

/// Entries by number and by name; both maps hold the same entries. Not thread safe.
class ProcessTable {
 public:
  using Entry = std::shared_ptr<ProcessEntry>;

  /// Adds an entry with a new number; its name must be free.
  Entry add(ProcessInfo info);
  void remove(const ProcessEntry& entry);
  /// Null where there is none, as below.
  [[nodiscard]] Entry find(const std::string& robot, const model::DeploymentKey& key) const;
  [[nodiscard]] Entry find(std::uint64_t id) const;
  [[nodiscard]] std::vector<Entry> of(const std::string& robot) const;

 private:
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, Entry> by_id_;
  std::map<std::pair<std::string, model::DeploymentKey>, Entry> by_name_;
};

}  // namespace segue::process_server::detail
