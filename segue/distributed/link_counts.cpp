// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/link_counts.hpp>

#include <segue/distributed/gateways.hpp>

#include <algorithm>

namespace segue::distributed::detail {

namespace {

using model::TaskId;
using Reports = std::vector<task_host::ConnectionReport>;

std::map<TaskId, task_host::ConnectionReport> reports_of_senders(const Reports& reports) {
  std::map<TaskId, task_host::ConnectionReport> to_sender;
  for (const auto& report : reports) {
    if (is_link_task(report.connection.to.task)) {
      to_sender.emplace(report.connection.to.task, report);
    }
  }
  return to_sender;
}

/// 0 where there would be less.
std::uint64_t difference(std::uint64_t all, std::int64_t part) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, static_cast<std::int64_t>(all) - part));
}

}  // namespace

void LinkCounts::note(const Reports& reports, bool complete) {
  const auto to_sender = reports_of_senders(reports);
  std::map<Key, Seen> seen;
  for (const auto& report : reports) {
    const auto sender = sender_of(report.connection.from.task);
    const auto first = sender ? to_sender.find(*sender) : to_sender.end();
    if (first == to_sender.end()) {
      continue;
    }
    Seen now{first->second.read, report.written, 0};
    const Key key{report.connection.from, report.connection.to};
    if (const auto known = seen_.find(key); known == seen_.end()) {
      now.not_owed =
          static_cast<std::int64_t>(difference(now.taken, static_cast<std::int64_t>(now.delivered)));
    } else {
      const Seen& last = known->second;
      const auto taken_before = now.taken < last.taken ? last.taken : 0;
      const auto delivered_before = now.delivered < last.delivered ? last.delivered : 0;
      now.not_owed = last.not_owed + static_cast<std::int64_t>(delivered_before) -
                     static_cast<std::int64_t>(taken_before);
    }
    seen.emplace(key, now);
  }
  if (!complete) {
    seen.merge(seen_);
  }
  seen_ = std::move(seen);
}

Reports LinkCounts::condense(Reports reports) const {
  const auto to_sender = reports_of_senders(reports);
  Reports whole;
  for (auto& report : reports) {
    if (is_link_task(report.connection.to.task)) {
      continue;
    }
    if (const auto sender = sender_of(report.connection.from.task)) {
      const auto first = to_sender.find(*sender);
      if (first == to_sender.end()) {
        continue;
      }
      const auto known = seen_.find({report.connection.from, report.connection.to});
      const std::int64_t not_owed = known == seen_.end() ? 0 : known->second.not_owed;
      const auto& sent = first->second;
      report.connection.from = sent.connection.from;
      report.error = report.error.empty() ? sent.error : report.error;
      report.latency = in_series(sent.latency, report.latency);
      report.dropped +=
          sent.dropped + difference(sent.read, not_owed + static_cast<std::int64_t>(report.written));
      report.written = difference(sent.written, not_owed);
    }
    whole.push_back(std::move(report));
  }
  return whole;
}

}  // namespace segue::distributed::detail
