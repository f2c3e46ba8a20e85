// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/commit_coordinator.hpp>

#include <segue/base/log.hpp>
#include <segue/fleet/action_ids.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace segue::fleet::detail {

namespace {

/// How long a process may take to settle, which no task waits for.
constexpr Duration kSettling = std::chrono::seconds(2);
/// How much later than its connection breaks a process may be known to have ended.
constexpr Duration kEndLag = std::chrono::milliseconds(300);

/// Calls work(item, outcome) for each item, all in parallel; the outcomes in the order of the items.
template <class Items, class Work>
std::vector<Result<void>> in_parallel(concurrent::ThreadPool& pool, const Items& items, const Work& work) {
  std::vector<Result<void>> outcomes(items.size());
  std::vector<concurrent::ThreadPool::Job> jobs;
  std::size_t next = 0;
  for (const auto& item : items) {
    jobs.emplace_back([&work, &item, &outcome = outcomes[next++]] { outcome = work(item); });
  }
  pool.run_all(std::move(jobs));
  return outcomes;
}

}  // namespace

void CommitCoordinator::note_waiting(std::initializer_list<RecordPtr> records) {
  const Lock lock(mutex_);
  waiting_.insert(records);
}

Result<void> CommitCoordinator::arm(const model::Transition& transition, TimePoint deadline) {
  if (transition.order != model::Order::Seamless) {
    return {};
  }
  Parts parts = parts_of(transition);
  const auto page = this->page();
  if (!page) {
    return page.error();
  }
  const std::uint64_t number = (*page)->begin();
  for (auto& [record, part] : parts) {
    part.what.page = *page;
    part.what.number = number;
    note_waiting({record});
  }
  const auto outcomes = in_parallel(fleet_.pool(), parts, [deadline](const auto& item) -> Result<void> {
    return arm(*item.first, item.second, deadline);
  });
  for (const auto& outcome : outcomes) {
    if (!outcome) {
      return outcome.error();
    }
  }
  const Lock lock(mutex_);
  armed_ = number;
  return {};
}

Result<void> CommitCoordinator::arm(ProcessRecord& process, const Part& part, TimePoint deadline) {
  const auto service = process.service();
  auto armed = service ? service->arm_commit(part.what, deadline) : Result<void>(process.unreachable());
  const bool may_have_ended = !armed && !part.begins && armed.error().code == ErrorCode::Unavailable;
  const bool has_ended = may_have_ended && process.wait_for_end(monotonic_now() + kEndLag);
  return has_ended ? Result<void>() : std::move(armed);
}

CommitCoordinator::Parts CommitCoordinator::parts_of(const model::Transition& transition) const {
  Parts parts;
  for (const auto& action : transition.actions) {
    const auto* what = std::get_if<model::ConnectionAction>(&action.what);
    if (what == nullptr || what->at_once) {
      continue;
    }
    if (action.kind == model::ActionKind::Connect && action.phase == model::Phase::Prepare) {
      for (const auto* end : {&what->connection.from, &what->connection.to}) {
        if (const auto located = fleet_.locate(end->task, Which::Next)) parts[located->record].begins = true;
      }
    } else if (action.kind == model::ActionKind::Disconnect && action.phase == model::Phase::Retire) {
      add_ending(what->connection, parts);
    }
  }
  return parts;
}

void CommitCoordinator::add_ending(const model::Connection& connection, Parts& parts) const {
  const auto writer = fleet_.locate(connection.from.task, Which::Current);
  const auto reader = fleet_.locate(connection.to.task, Which::Current);
  if (!writer || !reader) {
    return;  // its process has ended, and the connection with it
  }
  const model::Connection known = plain(connection);
  if (writer->record == reader->record) {
    parts[writer->record].what.within.push_back(known);
    return;
  }
  connector_.will_end(known);
  parts[writer->record].what.endpoints.push_back(
      {known, deploy::Side::Output, reader->record->incarnation()});
  parts[reader->record].what.endpoints.push_back({known, deploy::Side::Input, writer->record->incarnation()});
}

Result<std::shared_ptr<sample_link::CommitPage>> CommitCoordinator::page() {
  const Lock lock(mutex_);
  if (page_ == nullptr) {
    auto made = sample_link::CommitPage::create();
    if (!made) {
      return made;
    }
    page_ = std::move(*made);
  }
  return page_;
}

void CommitCoordinator::commit() {
  {
    const Lock lock(mutex_);
    if (armed_ != 0) {
      page_->commit(std::exchange(armed_, 0));
    }
  }
  connector_.settle();
  settle();
}

void CommitCoordinator::give_up() {
  {
    const Lock lock(mutex_);
    armed_ = 0;
  }
  connector_.give_up(RealClock::instance().now() + kSettling);
  settle();
}

void CommitCoordinator::settle() {
  std::set<RecordPtr> records;
  {
    const Lock lock(mutex_);
    records.swap(waiting_);
  }
  const TimePoint deadline = RealClock::instance().now() + kSettling;
  const auto outcomes =
      in_parallel(fleet_.pool(), records, [deadline](const RecordPtr& record) -> Result<void> {
        const auto service = record->answers() ? record->service() : nullptr;  // silence is not waited for
        return service ? service->settle(deadline) : Result<void>(record->unreachable());
      });
  auto outcome = outcomes.begin();
  for (const auto& record : records) {
    if (!*outcome++ && !record->ended()) {
      note_waiting({record});  // to be told before the next transition
    }
  }
}

}  // namespace segue::fleet::detail
