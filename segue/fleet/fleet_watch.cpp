// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/fleet/fleet.hpp>

#include <signal.h>

#include <algorithm>
#include <cerrno>

namespace segue::fleet::detail {

namespace {

/// How long a poll waits for a process that did not answer last time.
constexpr Duration kLittlePatience = std::chrono::milliseconds(200);
/// How much later than the end of the connection the process server may report the end of the process: at
/// most, and usually.
constexpr Duration kNewsLag = std::chrono::milliseconds(300);
constexpr Duration kUsualLag = std::chrono::milliseconds(20);
/// How long the end of a process waits for the others to forget its memory.
constexpr Duration kForgetting = std::chrono::milliseconds(200);
constexpr Duration kReconnect = std::chrono::milliseconds(500);

bool is_silence(const Error& error) {
  return error.code == ErrorCode::Unavailable || error.code == ErrorCode::DeadlineExceeded;
}

std::string with_tasks(std::string text, const std::vector<model::TaskId>& tasks) {
  if (tasks.empty()) {
    return text;
  }
  std::vector<std::string> names;
  for (const auto& task : tasks) {
    names.push_back(task.str());
  }
  return text + "; it held " + listed(names);
}

}  // namespace

std::vector<ProcessView> Fleet::poll() {
  const auto records = all();
  poll_processes(records);
  std::vector<ProcessView> views;
  for (const auto& record : records) {
    if (!record->ended()) {
      views.push_back(record->view());
    }
  }
  return views;
}

MergedView Fleet::poll_merged() {
  const auto views = poll();
  // Tasks and their connections get the same names although incarnations come and go meanwhile.
  const auto current = placements_.current();
  return merge(views, [&](const model::TaskId& task, const model::DeploymentKey& process) {
    return PlacementTable::name(current, task, process);
  });
}

void Fleet::poll_processes(const std::vector<RecordPtr>& records) {
  std::vector<std::uint64_t> numbers;
  for (const auto& record : records) {
    const auto request = record->request_poll();
    numbers.push_back(request.number);
    const bool polled = !request.start || pool_.submit([this, record] { run_polls(record); });
    if (!polled) {
      record->finish_poll(request.number, nullptr);
    }
  }
  const TimePoint begin = monotonic_now();
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Duration patience = records[i]->answers() ? options_.patience : kLittlePatience;
    if (!records[i]->wait_for_poll(numbers[i], std::max(begin + patience, monotonic_now()))) {
      report(*records[i], records[i]->give_up_poll(numbers[i]));
    }
  }
}

void Fleet::run_polls(const RecordPtr& record) {
  for (bool more = true; more;) {
    const std::uint64_t number = record->latest_request();
    const std::uint64_t poll = placements_.begin_poll();
    auto snapshot = fetch_snapshot(record);
    if (snapshot != nullptr) {
      update_placements(*record, poll, *snapshot);
    }
    const auto finished = record->finish_poll(number, std::move(snapshot));
    report(*record, finished.change);
    more = finished.more;
  }
}

std::shared_ptr<const deploy::Snapshot> Fleet::fetch_snapshot(const RecordPtr& record) {
  const auto service = record->service();
  auto seen =
      service ? service->snapshot() : Result<deploy::Snapshot>(fail(ErrorCode::Unavailable, "not connected"));
  if (service && !seen && !is_silence(seen.error())) {
    seen = service->snapshot();  // it answers, so it gets another try
  }
  const bool broken = !seen && seen.error().code == ErrorCode::Unavailable;
  if (broken && record != own_ && reconnect(record)) {
    if (const auto again = record->service()) {
      seen = again->snapshot();
    }
  }
  return seen ? std::make_shared<const deploy::Snapshot>(std::move(*seen)) : nullptr;
}

bool Fleet::reconnect(const RecordPtr& record) {
  if (record->end_expected() || record->wait_for_end(monotonic_now() + kUsualLag)) {
    return false;
  }
  if (!runs(*record)) {
    if (!record->wait_for_end(monotonic_now() + kNewsLag)) {
      process_server::ExitReason reason;
      reason.known = false;
      handle_end(record, reason);
    }
    return false;
  }
  return open(record, monotonic_now() + kReconnect).has_value();
}

bool Fleet::runs(const ProcessRecord& record) {
  const process_server::ProcessInfo& process = record.process();
  const auto listed = processes_.processes(launch_.robot);
  if (listed) {
    return std::any_of(listed->begin(), listed->end(), [&](const process_server::ProcessInfo& other) {
      return other.key == process.key && other.pid == process.pid;
    });
  }
  // The process server cannot be asked, but the system can.
  return ::kill(process.pid, 0) == 0 || errno == EPERM;
}

void Fleet::on_disconnected(const std::weak_ptr<ProcessRecord>& which) {
  const auto record = which.lock();
  if (record == nullptr || record->ended() || record->end_expected()) {
    return;
  }
  if (const auto request = record->request_poll(); request.start) {
    if (!pool_.submit([this, record] { run_polls(record); })) {
      record->finish_poll(request.number, nullptr);
    }
  }
}

void Fleet::on_exit(const process_server::ProcessInfo& process) {
  RecordPtr record;
  {
    const Lock lock(mutex_);
    if (const auto starting = starting_.find(process.key); starting != starting_.end()) {
      starting->second.exits.push_back(process);
    }
    const auto found = records_.find(process.key);
    if (found != records_.end() && found->second->process().pid == process.pid) {
      record = found->second;
    }
  }
  changed_.notify_all();
  if (record == nullptr) {
    return;
  }
  const process_server::ExitReason reason = process.exit.value_or(process_server::ExitReason{});
  if (!record->end_expected()) {
    handle_end(record, reason);
  } else if (!reason.requested) {
    report_defect(*record, reason);  // it ended by itself just before it would have been ended
  }
}

void Fleet::handle_end(const RecordPtr& record, const process_server::ExitReason& reason) {
  const std::string what = to_string(reason);
  const std::string last_lines = last_log_lines(record->process());
  const auto tasks = remove(record);  // at last: soon after it is missed, it is known why
  if (!tasks) {
    return;
  }
  const std::string output = last_lines.empty() ? "" : "; its log ends with:" + last_lines;
  events_.post(task_host::ProcessEvent{record->key(), with_tasks(what, *tasks) + output, true});
  for (const auto& task : *tasks) {
    report_task(task, TaskState::Fatal, "its process " + quote(to_string(record->key())) + ' ' + what);
  }
  pool_.submit([this, record] { release(record); });
}

void Fleet::report_defect(const ProcessRecord& record, const process_server::ExitReason& reason) {
  const bool by_itself = reason.known && (reason.signal != 0 ? reason.signal != SIGTERM : reason.status != 0);
  if (reason.killed || by_itself) {
    events_.post(task_host::ProcessEvent{record.key(), to_string(reason), true});
  }
}

std::optional<std::vector<model::TaskId>> Fleet::remove(const RecordPtr& record) {
  // Under the lock, so that a thread that sees ended() finds it in no table any more.
  const Lock lock(mutex_);
  if (!record->mark_ended()) {
    return std::nullopt;
  }
  const auto found = records_.find(record->key());
  if (found != records_.end() && found->second != record) {
    return std::vector<model::TaskId>();  // a successor has its name, and the tasks there are the successor's
  }
  if (found != records_.end()) {
    records_.erase(found);
  }
  return placements_.drop(record->key());
}

void Fleet::release(const RecordPtr& record) {
  record->set_service(nullptr, std::nullopt);
  const sample_link::Incarnation incarnation = record->incarnation();
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& other : all()) {
    const auto service = other->service();
    if (service == nullptr || incarnation == 0 ||
        !(other->process().adopted || other->has_mapped(incarnation))) {
      continue;
    }
    jobs.emplace_back([other, service, incarnation] {
      if (service->forget(incarnation)) {
        other->mark_unmapped(incarnation);
      }
    });
  }
  if (jobs.empty()) {
    return;
  }
  // Others wait for this: they do not wait for a process that does not answer.
  static_cast<void>(pool_.run([&pool = pool_, jobs = std::move(jobs)] { pool.run_all(jobs); },
                              monotonic_now() + kForgetting));
}

void Fleet::report(const ProcessRecord& record, const ProcessRecord::Change& change) {
  const ProcessView view = record.view();
  if (change.silent) {
    const std::string why = silence_text(record.key(), view.pid);
    events_.post(task_host::ProcessEvent{record.key(), why, false});
    if (view.is_silent()) {
      report_all_tasks(view, TaskState::Fatal, why);
    }
  }
  for (const SilenceWatch& watch : change.watches) {
    if (!pool_.submit([watch] { (*watch)(); })) {
      (*watch)();
    }
  }
  if (change.answers_again) {
    events_.post(task_host::ProcessEvent{record.key(), "answers again", false});
    report_all_tasks(view, std::nullopt, "");
  }
  for (const auto& task : change.hanging) {
    report_task(placements_.name(task, record.key()), TaskState::Fatal, hanging_text(view, task));
  }
  if (change.hanging_no_more.empty()) {
    return;
  }
  const model::TaskIndex known(view.snapshot->network);
  for (const auto& task : change.hanging_no_more) {
    if (const model::Task* found = known.find(task)) {
      report_task(placements_.name(task, record.key()), found->state, "what hung has returned");
    }
  }
}

void Fleet::blame(const Suspect& process, const std::string& why) {
  const auto record = find(process.incarnation);
  if (record == nullptr || record == own_ || !record->blame(why + "; a transition replaces it")) {
    return;
  }
  const ProcessView view = record->view();
  events_.post(task_host::ProcessEvent{record->key(), view.fault, false});
  report_all_tasks(view, TaskState::Fatal, view.fault);
}

void Fleet::report_all_tasks(const ProcessView& view, std::optional<TaskState> state,
                             const std::string& message) {
  if (view.snapshot == nullptr) {
    return;
  }
  for (const auto& task : view.snapshot->network.tasks) {
    report_task(placements_.name(task.id, view.deployment.key()), state.value_or(task.state), message);
  }
}

void Fleet::report_task(const model::TaskId& task, TaskState state, std::string message) {
  events_.post(task_host::TaskEvent{task, state, std::move(message)});
}

void Fleet::set_housekeeping(std::function<void()> work) {
  const Lock lock(mutex_);
  housekeeping_ = std::move(work);
}

void Fleet::watch() {
  Lock lock(mutex_);
  while (!changed_.wait_for(mutex_, options_.watch, [&]() SEGUE_REQUIRES(mutex_) { return closed_; })) {
    const auto work = housekeeping_;
    lock.unlock();
    if (work) {
      work();
    }
    lock.lock();
  }
}

}  // namespace segue::fleet::detail
