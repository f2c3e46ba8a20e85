// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/instance_calls.hpp>

#include <segue/base/error.hpp>

#include <algorithm>
#include <stop_token>
#include <utility>

namespace segue::runtime::detail {

namespace {

constexpr const char* kNobodyWaits = "carries out what nobody waits for any more";
constexpr const char* kLeft = "was left by an earlier runtime, and may work for nobody";

InstanceCalls::End end_of(const Result<type::Value>& answer) {
  using End = InstanceCalls::End;
  if (answer) return End::Answered;
  const ErrorCode code = answer.error().code;
  const bool is_unknown = code == ErrorCode::DeadlineExceeded || code == ErrorCode::Unavailable;
  return is_unknown ? End::Unknown : End::Answered;
}

}  // namespace

std::map<model::TaskId, InstanceCalls::Seen> InstanceCalls::processes() const {
  std::map<model::TaskId, Seen> seen;
  if (pools_.empty()) {
    return seen;
  }
  for (const auto& report : host_.tasks()) {
    if (pools_.find_task(report.id) != nullptr) {
      const bool answers = !report.unknown && report.state != TaskState::Fatal;
      seen.emplace(report.id, Seen{report.pid, answers, report.state == TaskState::Running});
    }
  }
  return seen;
}

Result<type::Value> InstanceCalls::call(const model::TaskId& task, std::string_view operation,
                                        const type::Value& arguments, const Wait& wait) {
  if (pools_.find_task(task) == nullptr) {
    return host_.call(task, operation, arguments, wait.deadline);
  }
  const std::uint64_t number = begin({task, processes()[task].pid});
  if (number == 0) {
    return fail(ErrorCode::InvalidState, task.str() + " is being stopped, because nobody has needed it");
  }
  auto answer = [&] {
    const std::stop_callback stopped(wait.stop, [&] {
      no_longer_wanted(number);
      notify_();
    });
    return host_.call(task, operation, arguments, wait.deadline);
  }();
  const End end = end_of(answer);
  ended(number, end);
  if (end != End::Answered) {
    notify_();
  }
  return answer;
}

std::uint64_t InstanceCalls::begin(Life life) {
  const Lock lock(mutex_);
  if (retired_.contains(life)) return 0;
  calls_[std::move(life)].push_back({++last_});
  return last_;
}

bool InstanceCalls::retire(const Life& life) {
  const Lock lock(mutex_);
  if (calls_.contains(life) || abandoned_.contains(life)) return false;
  retired_.insert(life);
  return true;
}

void InstanceCalls::no_longer_wanted(std::uint64_t call) {
  const Lock lock(mutex_);
  for (auto& [life, calls] : calls_) {
    const auto found = std::ranges::find(calls, call, &Call::number);
    if (found == calls.end()) continue;
    found->is_wanted = false;
    if (found == calls.begin()) abandoned_.emplace(life, kNobodyWaits);
  }
}

void InstanceCalls::ended(std::uint64_t call, End end) {
  const Lock lock(mutex_);
  for (auto& [life, calls] : calls_) {
    const auto found = std::ranges::find(calls, call, &Call::number);
    if (found == calls.end()) continue;
    const bool had_begun = found == calls.begin();
    calls.erase(found);
    if (had_begun && end == End::Answered) abandoned_.erase(life);
    const bool goes_on_for_nobody = had_begun && !calls.empty() && !calls.front().is_wanted;
    if (goes_on_for_nobody || (had_begun && end != End::Answered))
      abandoned_.insert_or_assign(life, kNobodyWaits);
  }
  std::erase_if(calls_, [](const auto& one) { return one.second.empty(); });
}

void InstanceCalls::starts(const model::TaskId& instance) {
  const Lock lock(mutex_);
  known_.insert(instance);
  std::erase_if(retired_, [&](const Life& life) { return life.instance == instance; });
}

void InstanceCalls::note_left(const Life& life) {
  if (known_.insert(life.instance).second) abandoned_.emplace(life, kLeft);
}

bool InstanceCalls::is_busy(const Life& life) const {
  const Lock lock(mutex_);
  return calls_.contains(life);
}

std::string InstanceCalls::why_abandoned(const Life& life) const {
  const Lock lock(mutex_);
  if (!known_.contains(life.instance)) return kLeft;
  const auto found = abandoned_.find(life);
  return found == abandoned_.end() ? std::string() : found->second;
}

std::map<InstanceCalls::Life, std::string> InstanceCalls::abandoned() {
  const auto seen = processes();
  const Lock lock(mutex_);
  for (const auto& [instance, process] : seen) {
    if (process.answers && process.runs) note_left({instance, process.pid});
  }
  std::map<Life, std::string> present;
  std::erase_if(abandoned_, [&](const auto& one) {
    const auto found = seen.find(one.first.instance);
    const bool is_there = found != seen.end() && found->second.pid == one.first.pid;
    if (is_there && found->second.answers) {
      present.insert(one);
    }
    return found != seen.end() && !is_there;
  });
  return present;
}

void InstanceCalls::forget(const Life& life) {
  const Lock lock(mutex_);
  abandoned_.erase(life);
  retired_.erase(life);
}

}  // namespace segue::runtime::detail
