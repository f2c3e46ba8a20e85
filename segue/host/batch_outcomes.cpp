// SPDX-License-Identifier: Apache-2.0
#include <segue/host/batch_outcomes.hpp>

#include <segue/base/log.hpp>

#include <exception>
#include <string>
#include <utility>

namespace segue::host {

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
    tell_now(lock);
  }
}

void BatchOutcomes::tell() {
  std::unique_lock lock(mutex_);
  tell_now(lock);
}

void BatchOutcomes::add(std::vector<Completed> ended) {
  std::unique_lock lock(mutex_);
  for (auto& one : ended) {
    note_now(std::move(one));
  }
  tell_now(lock);
}

void BatchOutcomes::fail_rest(const std::function<Error(std::size_t index)>& why) {
  std::unique_lock lock(mutex_);
  for (std::size_t index = 0; index < known_.size(); ++index) {
    if (!known_[index]) {
      note_now({index, why(index)});
    }
  }
  tell_now(lock);
}

std::size_t BatchOutcomes::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

void BatchOutcomes::wait() const {
  std::unique_lock lock(mutex_);
  all_told_.wait(lock, [&] { return told_ == known_.size() && !telling_; });
}

void BatchOutcomes::tell_now(std::unique_lock<std::mutex>& lock) {
  if (telling_ || waiting_.empty()) {
    return;
  }
  telling_ = true;
  while (!waiting_.empty()) {
    auto ended = std::exchange(waiting_, {});
    told_ += ended.size();
    lock.unlock();
    try {
      completed_(std::move(ended));
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "host", std::string("who was told of ended actions threw: ") + exception.what());
    }
    lock.lock();
  }
  telling_ = false;
  if (told_ < known_.size()) {
    return;
  }
  // What it holds goes with it, also where a hook that hangs holds on to this.
  const Completion done = std::exchange(completed_, nullptr);
  all_told_.notify_all();
  lock.unlock();
}

}  // namespace segue::host
