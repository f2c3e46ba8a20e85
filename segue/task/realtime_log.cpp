// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task/realtime_log.hpp>

#include <algorithm>
#include <cstring>
#include <string>
#include <thread>

namespace segue::task {

RealtimeLog& RealtimeLog::instance() {
  static auto* log = new RealtimeLog;  // never destroyed: a thread that hangs in a hook outlives main
  return *log;
}

RealtimeLog::RealtimeLog() : lines_(std::make_unique<std::array<Line, kLines>>()) {
  for (std::size_t i = 0; i < kLines; ++i)
    (*lines_)[i].turn.store(i, std::memory_order_relaxed);
}

// A bounded queue with many writers and readers (Vyukov). A line's `turn` says whose it is: at `position` the
// writer's, at position + 1 the reader's, at position + kLines the writer's of the next round. head_ and
// tail_ are relaxed: they only distribute positions, each to the one whose compare-exchange succeeds.
// - T1: the writer's release store of `turn` hands the line to the reader, whose load acquires it.
// - T2: the reader's release store hands it to the writer of the next round, whose load acquires it.
bool RealtimeLog::push(LogLevel level, std::string_view source, std::string_view message) noexcept {
  std::size_t position = head_.load(std::memory_order_relaxed);
  Line* line = nullptr;
  while (true) {
    line = &(*lines_)[position % kLines];
    const std::size_t turn = line->turn.load(std::memory_order_acquire);  // pairs with T2
    if (turn == position) {
      if (head_.compare_exchange_weak(position, position + 1, std::memory_order_relaxed)) break;
    } else if (turn < position) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return false;
    } else {
      position = head_.load(std::memory_order_relaxed);
    }
  }
  line->level = level;
  line->source_size = static_cast<std::uint8_t>(std::min(source.size(), kSourceBytes));
  line->message_size = static_cast<std::uint8_t>(std::min(message.size(), kMessageBytes));
  std::memcpy(line->source.data(), source.data(), line->source_size);
  std::memcpy(line->message.data(), message.data(), line->message_size);
  line->turn.store(position + 1, std::memory_order_release);  // T1
  return true;
}

bool RealtimeLog::pop(Line& copy) noexcept {
  std::size_t position = tail_.load(std::memory_order_relaxed);
  while (true) {
    Line& line = (*lines_)[position % kLines];
    const std::size_t turn = line.turn.load(std::memory_order_acquire);  // pairs with T1
    if (turn < position + 1) return false;
    if (turn > position + 1) {
      position = tail_.load(std::memory_order_relaxed);
      continue;
    }
    if (!tail_.compare_exchange_weak(position, position + 1, std::memory_order_relaxed)) continue;
    copy.level = line.level;
    copy.source_size = line.source_size;
    copy.message_size = line.message_size;
    copy.source = line.source;
    copy.message = line.message;
    line.turn.store(position + kLines, std::memory_order_release);  // T2
    return true;
  }
}

std::size_t RealtimeLog::drain() {
  const Lock lock(draining_);
  std::size_t count = 0;
  Line line;
  while (pop(line)) {
    segue::log(line.level, {line.source.data(), line.source_size}, {line.message.data(), line.message_size});
    ++count;
  }
  const std::uint64_t lost = lost_.load(std::memory_order_relaxed);
  const std::uint64_t reported = lost_reported_.exchange(lost, std::memory_order_relaxed);
  if (lost > reported) {
    segue::log(LogLevel::Warning, "log",
               std::to_string(lost - reported) + " lines of tasks were lost: too many at once");
  }
  return count;
}

struct RealtimeLogDrain::Implementation {
  Mutex mutex;
  ConditionVariable stopped;
  bool stop SEGUE_GUARDED_BY(mutex) = false;
  std::thread thread;
};

RealtimeLogDrain::RealtimeLogDrain(std::chrono::milliseconds period)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->thread = std::thread([this, period] {
    const Lock lock(implementation_->mutex);
    while (!implementation_->stop) {
      implementation_->stopped.wait_until(implementation_->mutex, monotonic_now() + period);
      RealtimeLog::instance().drain();
    }
  });
}

RealtimeLogDrain::~RealtimeLogDrain() {
  {
    const Lock lock(implementation_->mutex);
    implementation_->stop = true;
  }
  implementation_->stopped.notify_all();
  implementation_->thread.join();
}

}  // namespace segue::task
