// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/process_table.hpp>

namespace segue::process_server::detail {

ProcessTable::Entry ProcessTable::add(ProcessInfo info) {
  auto entry = std::make_shared<ProcessEntry>();
  entry->id = ++last_;
  entry->info = std::move(info);
  by_id_[entry->id] = entry;
  by_name_[{entry->info.robot, entry->info.key}] = entry;
  return entry;
}

void ProcessTable::remove(const ProcessEntry& entry) {
  // Read before the maps let go of it: they may hold its last references.
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

}  // namespace segue::process_server::detail
