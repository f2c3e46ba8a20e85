// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/process_memory.hpp>

#include <unistd.h>

#include <fstream>
#include <map>
#include <string>
#include <utility>

namespace segue::runtime::detail {

namespace {

/// Resident memory of a process in bytes; 0 if there is no such process.
std::uint64_t resident(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::uint64_t size = 0;
  std::uint64_t pages = 0;
  file >> size >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

MemoryOf memory_of(const task_host::TaskHost& host) {
  std::map<model::DeploymentKey, int> pids;
  const bool alone = host.computers().empty();
  for (const auto& task : host.tasks()) {
    if (alone || task.process.host == model::kLocalHost) {  // other computers count their own
      pids.emplace(task.process, task.pid);
    }
  }
  return [pids = std::move(pids)](const model::DeploymentKey& process) {
    const auto found = pids.find(process);
    return found == pids.end() ? 0 : resident(found->second);
  };
}

}  // namespace segue::runtime::detail
