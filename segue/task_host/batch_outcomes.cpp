// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/batch_outcomes.hpp>

#include <segue/base/log.hpp>

#include <exception>
#include <string>
#include <utility>

namespace segue::task_host {

BatchOutcomes::BatchOutcomes(std::size_t count, Completion completed)
    : completed_(std::move(completed)), known_(count, false) {}

bool BatchOutcomes::note_now(Completed one) {
  if (one.index >= known_.size() || known_[one.index]) {
    return false;
  }
  known_[one.index] = true;
  ++ended_;
  waiting_.push_back(std::move(one));
  return true;
}

void BatchOutcomes::note(Completed one) {
  std::unique_lock lock(mutex_);
  if (note_now(std::move(one)) && ended_ == known_.size()) {
    report_now(lock);
  }
}

void BatchOutcomes::report() {
  std::unique_lock lock(mutex_);
  report_now(lock);
}

void BatchOutcomes::add(std::vector<Completed> ended) {
  std::unique_lock lock(mutex_);
  for (auto& one : ended) {
    note_now(std::move(one));
  }
  report_now(lock);
}

void BatchOutcomes::fail_rest(const std::function<Error(std::size_t index)>& why) {
  std::unique_lock lock(mutex_);
  for (std::size_t index = 0; index < known_.size(); ++index) {
    if (!known_[index]) {
      note_now({index, why(index)});
    }
  }
  report_now(lock);
}

std::size_t BatchOutcomes::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

void BatchOutcomes::report_now(std::unique_lock<std::mutex>& lock) {
  if (reporting_ || waiting_.empty()) {
    return;
  }
  reporting_ = true;
  while (!waiting_.empty()) {
    auto ended = std::exchange(waiting_, {});
    reported_ += ended.size();
    lock.unlock();
    try {
      completed_(std::move(ended));
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "host", std::string("the receiver of outcomes threw: ") + exception.what());
    }
    lock.lock();
  }
  reporting_ = false;
  if (reported_ < known_.size()) {
    return;
  }
  // Released here, since a hook that hangs may keep this alive for ever.
  const Completion done = std::exchange(completed_, nullptr);
  lock.unlock();
}

}  // namespace segue::task_host
