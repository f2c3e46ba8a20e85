// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/link_counts.hpp>

#include <segue/hosts/gateways.hpp>

namespace segue::hosts::detail {

namespace {

using model::TaskId;
using Reports = std::vector<host::ConnectionReport>;

std::map<TaskId, host::ConnectionReport> reports_of_senders(const Reports& reports) {
  std::map<TaskId, host::ConnectionReport> to_sender;
  for (const auto& report : reports) {
    if (is_link_task(report.connection.to.task)) {
      to_sender.emplace(report.connection.to.task, report);
    }
  }
  return to_sender;
}

std::uint64_t difference(std::uint64_t all, std::uint64_t part) {
  return all > part ? all - part : 0;
}

}  // namespace

void LinkCounts::note(const Reports& reports) {
  const auto to_sender = reports_of_senders(reports);
  std::map<Key, std::uint64_t> before;
  for (const auto& report : reports) {
    const auto sender = sender_of(report.connection.from.task);
    const auto first = sender ? to_sender.find(*sender) : to_sender.end();
    if (first == to_sender.end()) {
      continue;
    }
    const Key key{report.connection.from, report.connection.to};
    const auto known = before_.find(key);
    before.emplace(key,
                   known != before_.end() ? known->second : difference(first->second.read, report.written));
  }
  before_ = std::move(before);
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
      const auto before = before_.find({report.connection.from, report.connection.to});
      const std::uint64_t missed = before == before_.end() ? 0 : before->second;
      const auto& sent = first->second;
      report.connection.from = sent.connection.from;
      report.dropped += sent.dropped + difference(difference(sent.read, missed), report.written);
      report.written = difference(sent.written, missed);
    }
    whole.push_back(std::move(report));
  }
  return whole;
}

}  // namespace segue::hosts::detail
