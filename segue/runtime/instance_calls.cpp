// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/instance_calls.hpp>

#include <segue/base/error.hpp>

#include <algorithm>
#include <stop_token>
#include <utility>

namespace segue::runtime::detail {

namespace {

constexpr const char* kNobodyWaits = "carries out what nobody waits for any more";

}  // namespace

std::map<model::TaskId, int> InstanceCalls::processes() const {
  std::map<model::TaskId, int> pids;
  if (pools_.empty()) {
    return pids;
  }
  for (const auto& report : host_.tasks()) {
    if (pools_.find_task(report.id) != nullptr) {
      pids.emplace(report.id, report.pid);
    }
  }
  return pids;
}

Result<type::Value> InstanceCalls::call(const model::TaskId& task, std::string_view operation,
                                        const type::Value& arguments, const Wait& wait) {
  if (pools_.find_task(task) == nullptr) {
    return host_.call(task, operation, arguments, wait.deadline);
  }
  const std::uint64_t number = begin({task, processes()[task]});
  auto answer = [&] {
    const std::stop_callback stopped(wait.stop, [&] {
      no_longer_wanted(number);
      notify_();
    });
    return host_.call(task, operation, arguments, wait.deadline);
  }();
  const bool is_answered = answer || (answer.error().code != ErrorCode::DeadlineExceeded &&
                                      answer.error().code != ErrorCode::Unavailable);
  ended(number, is_answered);
  if (!is_answered) {
    notify_();
  }
  return answer;
}

std::uint64_t InstanceCalls::begin(Life life) {
  const std::lock_guard lock(mutex_);
  calls_[std::move(life)].push_back({++last_});
  return last_;
}

void InstanceCalls::no_longer_wanted(std::uint64_t call) {
  const std::lock_guard lock(mutex_);
  for (auto& [life, calls] : calls_) {
    const auto found = std::ranges::find(calls, call, &Call::number);
    if (found == calls.end()) continue;
    found->is_wanted = false;
    if (found == calls.begin()) abandoned_.emplace(life, kNobodyWaits);
  }
}

void InstanceCalls::ended(std::uint64_t call, bool is_answered) {
  const std::lock_guard lock(mutex_);
  for (auto& [life, calls] : calls_) {
    const auto found = std::ranges::find(calls, call, &Call::number);
    if (found == calls.end()) continue;
    const bool had_begun = found == calls.begin();
    calls.erase(found);
    if (had_begun && is_answered) abandoned_.erase(life);
    const bool goes_on_for_nobody = had_begun && !calls.empty() && !calls.front().is_wanted;
    if (goes_on_for_nobody || (had_begun && !is_answered)) abandoned_.emplace(life, kNobodyWaits);
  }
  std::erase_if(calls_, [](const auto& one) { return one.second.empty(); });
}

void InstanceCalls::abandon_all(const std::string& why) {
  const auto pids = processes();
  const std::lock_guard lock(mutex_);
  for (const auto& [instance, pid] : pids) {
    abandoned_.insert_or_assign(Life{instance, pid}, why);
  }
}

bool InstanceCalls::is_busy(const Life& life) const {
  const std::lock_guard lock(mutex_);
  return calls_.contains(life);
}

std::string InstanceCalls::why_abandoned(const Life& life) const {
  const std::lock_guard lock(mutex_);
  const auto found = abandoned_.find(life);
  return found == abandoned_.end() ? std::string() : found->second;
}

std::map<InstanceCalls::Life, std::string> InstanceCalls::abandoned() {
  const auto pids = processes();
  const std::lock_guard lock(mutex_);
  std::map<Life, std::string> present;
  std::erase_if(abandoned_, [&](const auto& one) {
    const auto found = pids.find(one.first.instance);
    const bool is_there = found != pids.end() && found->second == one.first.pid;
    if (is_there) {
      present.insert(one);
    }
    return found != pids.end() && !is_there;
  });
  return present;
}

void InstanceCalls::forget(const Life& life) {
  const std::lock_guard lock(mutex_);
  abandoned_.erase(life);
}

}  // namespace segue::runtime::detail
