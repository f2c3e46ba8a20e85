// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/batch_outcomes.hpp>

#include <segue/base/log.hpp>

#include <exception>
#include <string>
#include <utility>

namespace segue::task_host {

BatchOutcomes::BatchOutcomes(std::vector<model::Action> actions, Completion completed)
    : actions_(std::move(actions)), completed_(std::move(completed)), known_(actions_.size(), false) {}

bool BatchOutcomes::note_now(Completed one) {
  if (one.index >= known_.size() || known_[one.index]) {
    return false;
  }
  if (!one.outcome) {
    one.outcome = std::move(one.outcome.error()).about(actions_[one.index].label());
  }
  known_[one.index] = true;
  ++ended_;
  waiting_.push_back(std::move(one));
  return true;
}

void BatchOutcomes::note(Completed one) {
  Completion released;
  const Lock lock(mutex_);
  if (note_now(std::move(one)) && ended_ == known_.size()) {
    released = report_now();
  }
}

void BatchOutcomes::report() {
  Completion released;
  const Lock lock(mutex_);
  released = report_now();
}

void BatchOutcomes::add(std::vector<Completed> ended) {
  Completion released;
  const Lock lock(mutex_);
  for (auto& one : ended) {
    note_now(std::move(one));
  }
  released = report_now();
}

void BatchOutcomes::fail_rest(const std::function<Error(std::size_t index)>& why) {
  Completion released;
  const Lock lock(mutex_);
  for (std::size_t index = 0; index < known_.size(); ++index) {
    if (!known_[index]) {
      note_now({index, why(index)});
    }
  }
  released = report_now();
}

void BatchOutcomes::fail_rest(const Error& why) {
  fail_rest([&](std::size_t) { return why; });
}

std::size_t BatchOutcomes::ended() const {
  const Lock lock(mutex_);
  return ended_;
}

Completion BatchOutcomes::report_now() {
  if (reporting_ || waiting_.empty()) {
    return {};
  }
  reporting_ = true;
  while (!waiting_.empty()) {
    auto ended = std::exchange(waiting_, {});
    reported_ += ended.size();
    const Unlocked unlocked(mutex_);
    try {
      completed_(std::move(ended));
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "host", std::string("the receiver of outcomes threw: ") + exception.what());
    }
  }
  reporting_ = false;
  return reported_ < known_.size() ? Completion() : std::exchange(completed_, nullptr);
}

}  // namespace segue::task_host
