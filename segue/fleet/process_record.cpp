// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/process_record.hpp>

#include <segue/base/text.hpp>
#include <segue/process_server/process_log.hpp>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

namespace segue::fleet::detail {

namespace {

/// The tasks in `all` that are not among `others`.
std::vector<model::TaskId> without(const std::vector<model::TaskId>& all,
                                   const std::vector<model::TaskId>& others) {
  std::vector<model::TaskId> left;
  std::copy_if(all.begin(), all.end(), std::back_inserter(left), [&](const model::TaskId& task) {
    return std::find(others.begin(), others.end(), task) == others.end();
  });
  return left;
}

}  // namespace

namespace {

constexpr std::size_t kTailBytes = 4096;
constexpr std::size_t kTailLines = 8;

}  // namespace

std::string last_log_lines(const process_server::ProcessInfo& process) {
  const auto tail = process_server::log_tail(process.log, kTailLines, kTailBytes);
  std::istringstream lines(tail ? tail->text : std::string());
  std::string indented;
  for (std::string line; std::getline(lines, line);) {
    indented += "\n  " + line;
  }
  return indented;
}

ConnectionTurn::ConnectionTurn(ProcessRecord& process, TimePoint deadline)
    : process_(process), given_([&] {
        Lock lock(process.mutex_);
        const bool free = process.changed_.wait_until(
            process.mutex_, deadline,
            [&]() SEGUE_REQUIRES(process.mutex_) { return process.turns_ < kMost; });
        if (free) ++process.turns_;
        return free;
      }()) {}

ConnectionTurn::~ConnectionTurn() {
  if (!given_) return;
  {
    const Lock lock(process_.mutex_);
    --process_.turns_;
  }
  process_.changed_.notify_all();
}

Error ConnectionTurn::error() const {
  return fail(ErrorCode::DeadlineExceeded,
              "process " + quote(to_string(process_.key())) + " is still busy with other connections");
}

ProcessRecord::ProcessRecord(model::Deployment deployment, process_server::ProcessInfo process)
    : key_(deployment.key()), process_(std::move(process)), deployment_(std::move(deployment)) {}

ProcessView ProcessRecord::view() const {
  const Lock lock(mutex_);
  return {deployment_, process_.pid, incarnation_, last_known(), answers_, fault_};
}

bool ProcessRecord::blame(std::string why) {
  const Lock lock(mutex_);
  if (!fault_.empty()) {
    return false;
  }
  fault_ = std::move(why);
  return true;
}

std::shared_ptr<const deploy::Snapshot> ProcessRecord::last_known() const {
  if (answers_ || created_.empty()) {
    return snapshot_;
  }
  auto known =
      snapshot_ ? std::make_shared<deploy::Snapshot>(*snapshot_) : std::make_shared<deploy::Snapshot>();
  std::set<model::TaskId> seen;
  for (const auto& task : known->network.tasks) {
    seen.insert(task.id);
  }
  model::Deployment placements;
  for (const auto& [number, action] : created_) {
    if (!seen.insert(action.definition.id).second) {
      continue;
    }
    known->network.tasks.push_back(action.definition);
    placements.tasks.push_back({action.definition.id, action.name});
    task_host::TaskReport report;
    report.id = action.definition.id;
    report.component = action.definition.component;
    known->tasks.push_back(std::move(report));
  }
  known->network.deployments.push_back(std::move(placements));
  return known;
}

void ProcessRecord::note_created(const model::ConfigAction& action) {
  const Lock lock(mutex_);
  created_.emplace_back(requested_, action);
}

void ProcessRecord::note_removed(const model::TaskId& task) {
  const Lock lock(mutex_);
  std::erase_if(created_, [&](const auto& item) { return item.second.definition.id == task; });
}

Error ProcessRecord::unreachable() const {
  return fail(ErrorCode::Unavailable, "process " + quote(to_string(key_)) + " cannot be reached");
}

sample_link::Incarnation ProcessRecord::incarnation() const {
  const Lock lock(mutex_);
  return incarnation_;
}

std::shared_ptr<deploy::DeploymentService> ProcessRecord::service() const {
  const Lock lock(mutex_);
  return service_;
}

std::shared_ptr<deploy::DeploymentService> ProcessRecord::set_service(
    std::shared_ptr<deploy::DeploymentService> service, std::optional<deploy::DeploymentInfo> info) {
  const Lock lock(mutex_);
  if (info) {
    incarnation_ = info->incarnation;
    deployment_ = std::move(info->deployment);
    deployment_.host = key_.host;
    deployment_.process = key_.process;
    deployment_.tasks.clear();
  }
  return std::exchange(service_, std::move(service));
}

ProcessRecord::PollRequest ProcessRecord::request_poll() {
  const Lock lock(mutex_);
  return {++requested_, !std::exchange(polling_, true)};
}

std::uint64_t ProcessRecord::latest_request() const {
  const Lock lock(mutex_);
  return requested_;
}

ProcessRecord::Finished ProcessRecord::finish_poll(std::uint64_t number,
                                                   std::shared_ptr<const deploy::Snapshot> snapshot) {
  Finished finished;
  {
    const Lock lock(mutex_);
    finished_ = number;
    finished.more = requested_ > number;
    polling_ = finished.more;
    if (snapshot != nullptr) {
      snapshot_ = std::move(snapshot);
      answered_ = number;
      std::erase_if(created_, [&](const auto& item) { return item.first < number; });
      finished.change = answering_now();
    } else {
      finished.change = silent_now();
    }
  }
  changed_.notify_all();
  return finished;
}

ProcessRecord::Change ProcessRecord::give_up_poll(std::uint64_t number) {
  const Lock lock(mutex_);
  return answered_ >= number ? Change{} : silent_now();
}

ProcessRecord::Change ProcessRecord::silent_now() {
  Change change;
  const bool before = std::exchange(answers_, false);
  change.silent = before && !end_expected_ && !ended_;
  if (change.silent) {
    change.watches = take_watches();
  }
  return change;
}

std::vector<SilenceWatch> ProcessRecord::take_watches() {
  std::vector<SilenceWatch> kept;
  for (const auto& one : std::exchange(watches_, {})) {
    if (auto watch = one.lock()) {
      kept.push_back(std::move(watch));
    }
  }
  return kept;
}

void ProcessRecord::add(const SilenceWatch& watch) {
  {
    const Lock lock(mutex_);
    if (answers_) {
      std::erase_if(watches_, [](const auto& one) { return one.expired(); });
      watches_.push_back(watch);
      return;
    }
  }
  (*watch)();
}

ProcessRecord::Change ProcessRecord::answering_now() {
  Change change;
  const bool before = std::exchange(answers_, true);
  if (end_expected_ || ended_) {
    return change;
  }
  change.answers_again = !before;
  change.hanging = without(snapshot_->hanging, hanging_);
  change.hanging_no_more = without(hanging_, snapshot_->hanging);
  hanging_ = snapshot_->hanging;
  return change;
}

bool ProcessRecord::wait_for_poll(std::uint64_t number, TimePoint deadline) const {
  Lock lock(mutex_);
  return changed_.wait_until(mutex_, deadline,
                             [&]() SEGUE_REQUIRES(mutex_) { return finished_ >= number || ended_; });
}

bool ProcessRecord::answers() const {
  const Lock lock(mutex_);
  return answers_;
}

void ProcessRecord::expect_end(bool expected) {
  const Lock lock(mutex_);
  end_expected_ = expected;
}

bool ProcessRecord::end_expected() const {
  const Lock lock(mutex_);
  return end_expected_;
}

bool ProcessRecord::mark_ended() {
  bool first = false;
  {
    const Lock lock(mutex_);
    first = !std::exchange(ended_, true);
  }
  changed_.notify_all();
  return first;
}

bool ProcessRecord::ended() const {
  const Lock lock(mutex_);
  return ended_;
}

bool ProcessRecord::wait_for_end(TimePoint deadline) const {
  Lock lock(mutex_);
  return changed_.wait_until(mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) { return ended_; });
}

bool ProcessRecord::has_mapped(sample_link::Incarnation peer) const {
  const Lock lock(mutex_);
  return peers_.contains(peer);
}

void ProcessRecord::mark_mapped(sample_link::Incarnation peer) {
  const Lock lock(mutex_);
  peers_.insert(peer);
}

void ProcessRecord::mark_unmapped(sample_link::Incarnation peer) {
  const Lock lock(mutex_);
  peers_.erase(peer);
}

}  // namespace segue::fleet::detail
