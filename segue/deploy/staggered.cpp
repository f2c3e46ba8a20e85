// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/staggered.hpp>

#include <segue/base/log.hpp>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>

namespace segue::deploy::detail {

/// Shared with the threads, which may outlive the rest.
struct Staggered::Line {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> waiting;
  std::size_t returned = 0;
};

Staggered::Staggered(std::vector<std::function<void()>> steps, Duration patience)
    : line_(std::make_shared<Line>()), count_(steps.size()), patience_(patience) {
  line_->waiting.assign(std::make_move_iterator(steps.begin()), std::make_move_iterator(steps.end()));
}

Staggered::~Staggered() {
  const std::lock_guard lock(line_->mutex);
  line_->waiting.clear();
}

void Staggered::work(const std::shared_ptr<Line>& line) {
  std::unique_lock lock(line->mutex);
  while (!line->waiting.empty()) {
    const auto step = std::move(line->waiting.front());
    line->waiting.pop_front();
    lock.unlock();
    step();
    lock.lock();
    ++line->returned;
    line->changed.notify_all();
  }
}

void Staggered::add_worker() {
  try {
    std::thread([line = line_] { work(line); }).detach();
  } catch (const std::system_error& error) {
    log(LogLevel::Error, "deploy", std::string("no thread to stop tasks on: ") + error.what());
  }
}

bool Staggered::run(TimePoint deadline) {
  std::unique_lock lock(line_->mutex);
  std::size_t seen = line_->returned;
  TimePoint next_worker{};
  while (line_->returned < count_) {
    const TimePoint now = RealClock::instance().now();
    if (now >= deadline) {
      return false;
    }
    if (line_->returned != seen) {
      seen = line_->returned;
      next_worker = now + patience_;
    } else if (!line_->waiting.empty() && now >= next_worker) {
      add_worker();
      next_worker = now + patience_;
    }
    line_->changed.wait_until(lock, line_->waiting.empty() ? deadline : std::min(next_worker, deadline));
  }
  return true;
}

}  // namespace segue::deploy::detail
