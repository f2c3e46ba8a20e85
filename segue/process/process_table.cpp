// SPDX-License-Identifier: Apache-2.0
#include <segue/process/process_table.hpp>

#include <sys/wait.h>

#include <cerrno>
#include <csignal>

namespace segue::process::detail {

ProcessTable::Entry ProcessTable::add(ProcessInfo info) {
  auto entry = std::make_shared<ProcessEntry>();
  entry->id = ++last_;
  entry->info = std::move(info);
  by_id_[entry->id] = entry;
  by_name_[{entry->info.robot, entry->info.key}] = entry;
  return entry;
}

void ProcessTable::remove(const ProcessEntry& entry) {
  // `entry` may be gone with the last of the two.
  const auto id = entry.id;
  by_name_.erase({entry.info.robot, entry.info.key});
  by_id_.erase(id);
}

ProcessTable::Entry ProcessTable::find(const std::string& robot, const model::DeploymentKey& key) const {
  const auto found = by_name_.find({robot, key});
  return found == by_name_.end() ? nullptr : found->second;
}

ProcessTable::Entry ProcessTable::find(std::uint64_t id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

std::vector<ProcessTable::Entry> ProcessTable::of(const std::string& robot) const {
  std::vector<Entry> entries;
  for (const auto& [name, entry] : by_name_) {
    if (name.first == robot) entries.push_back(entry);
  }
  return entries;
}

void kill_group(int pid) {
  // 0 and 1 would mean others.
  if (pid > 1) ::kill(-pid, SIGKILL);
}

ExitReason reap(int pidfd) {
  siginfo_t ended{};
  int done = 0;
  do {
    done = ::waitid(P_PIDFD, static_cast<id_t>(pidfd), &ended, WEXITED | WNOHANG);
  } while (done != 0 && errno == EINTR);
  ExitReason reason;
  reason.known = done == 0 && ended.si_pid != 0;
  if (!reason.known) return reason;
  if (ended.si_code == CLD_EXITED) {
    reason.status = ended.si_status;
  } else {
    reason.signal = ended.si_status;
    reason.core_dumped = ended.si_code == CLD_DUMPED;
  }
  return reason;
}

void reap_child(int pid) {
  siginfo_t ended{};
  while (::waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED) != 0 && errno == EINTR) {
  }
}

}  // namespace segue::process::detail
