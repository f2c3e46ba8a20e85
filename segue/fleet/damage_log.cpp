// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/damage_log.hpp>

#include <algorithm>

namespace segue::fleet::detail {

namespace {

bool contains(const std::vector<Suspect>& suspects, const Suspect& one) {
  return std::find(suspects.begin(), suspects.end(), one) != suspects.end();
}

}  // namespace

DamageLog::Found DamageLog::note(const MergedView& seen, TimePoint now) {
  const Lock lock(mutex_);
  Found found;
  for (const auto& connection : seen.network.connections) {
    damaged_.erase({connection.from, connection.to});
  }
  while (!events_.empty() && now - events_.front().time > kPeriod) {
    events_.pop_front();
  }
  for (const DamagedConnection& one : seen.damaged) {
    if (!damaged_.try_emplace({one.connection.from, one.connection.to}, one).second) {
      continue;
    }
    events_.push_back({now, one.suspects});
    found.damaged.push_back(one);
    for (auto& culprit : find_culprits(one.suspects)) {
      found.culprits.push_back(std::move(culprit));
    }
  }
  return found;
}

std::vector<DamageLog::Culprit> DamageLog::find_culprits(const std::vector<Suspect>& suspects) {
  std::vector<Culprit> culprits;
  for (const Suspect& suspect : suspects) {
    if (!is_at_fault(suspect)) {
      continue;
    }
    culprits.push_back({suspect, suspect_text({suspect}) + " has overwritten shared memory of " +
                                     std::to_string(kMost) + " connections"});
    std::erase_if(events_, [&](const Event& event) { return contains(event.suspects, suspect); });
  }
  return culprits;
}

bool DamageLog::is_at_fault(const Suspect& suspect) const {
  std::size_t count = 0;
  std::vector<Suspect> others;  // that can have overwritten all the same
  for (const Event& event : events_) {
    if (!contains(event.suspects, suspect)) {
      continue;
    }
    if (count++ == 0) {
      others = event.suspects;
    }
    std::erase_if(others, [&](const Suspect& other) { return !contains(event.suspects, other); });
  }
  return count >= kMost && others.size() == 1;
}

void DamageLog::clear() {
  const Lock lock(mutex_);
  damaged_.clear();
}

std::vector<task_host::ConnectionReport> DamageLog::reports() const {
  const Lock lock(mutex_);
  std::vector<task_host::ConnectionReport> reports;
  for (const auto& [key, one] : damaged_) {
    task_host::ConnectionReport report;
    report.connection = one.connection;
    report.error = damage_text(one);
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace segue::fleet::detail
