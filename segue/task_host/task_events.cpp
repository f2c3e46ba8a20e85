// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/task_events.hpp>

#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>

#include <exception>
#include <utility>

namespace segue::task_host::detail {

void TaskEvents::Source::add(TaskState state) noexcept {
  std::uint64_t states = states_.load(std::memory_order_relaxed);
  const auto number = static_cast<std::uint64_t>(state) + 1;
  while (!states_.compare_exchange_weak(states, (states << 8U) | number, std::memory_order_release,  // A1
                                        std::memory_order_relaxed)) {
  }
}

void TaskEvents::note(const std::shared_ptr<Source>& source, TaskState state) noexcept {
  source->add(state);
  // Whoever takes the source clears the flag before it takes the states, and sees this one then.
  if (source->queued_.exchange(true, std::memory_order_acq_rel)) {  // A2
    return;
  }
  source->self_ = source;
  Source* newest = queued_.load(std::memory_order_relaxed);
  do {
    source->next_ = newest;
  } while (!queued_.compare_exchange_weak(newest, source.get(), std::memory_order_release,  // A3
                                          std::memory_order_relaxed));
  rings_.fetch_add(1, std::memory_order_release);  // A4
  rings_.notify_one();
}

void TaskEvents::set_listener(Listener listener) {
  const Lock setting(setting_);
  if (thread_.joinable()) {
    stop_.store(true, std::memory_order_relaxed);
    rings_.fetch_add(1, std::memory_order_release);  // A4
    rings_.notify_one();
    thread_.join();
  }
  take([](const Source&, std::uint64_t) {});
  if (!listener) {
    return;
  }
  listener_ = std::move(listener);
  stop_.store(false, std::memory_order_relaxed);
  thread_ = concurrent::start_thread("segue-events", [this] { run(); });
}

void TaskEvents::run() {
  while (true) {
    const std::uint32_t seen = rings_.load(std::memory_order_acquire);  // pairs with A4
    if (stop_.load(std::memory_order_relaxed)) {
      return;
    }
    take([this](const Source& source, std::uint64_t states) { tell(source, states); });
    rings_.wait(seen, std::memory_order_acquire);  // pairs with A4
  }
}

void TaskEvents::take(const std::function<void(const Source&, std::uint64_t states)>& handle) {
  Source* newest = queued_.exchange(nullptr, std::memory_order_acquire);  // pairs with A3
  Source* oldest = nullptr;
  while (newest != nullptr) {
    Source* const next = std::exchange(newest->next_, oldest);
    oldest = std::exchange(newest, next);
  }
  while (oldest != nullptr) {
    Source* const next = oldest->next_;
    const std::shared_ptr<Source> source = std::move(oldest->self_);
    source->queued_.exchange(false, std::memory_order_acq_rel);               // A2
    handle(*source, source->states_.exchange(0, std::memory_order_acquire));  // pairs with A1
    oldest = next;
  }
}

void TaskEvents::tell(const Source& source, std::uint64_t states) const {
  const auto task = source.task_.lock();
  for (int byte = 7; byte >= 0 && task != nullptr; --byte) {
    const std::uint64_t number = (states >> (8U * static_cast<unsigned>(byte))) & 0xFFU;
    if (number == 0) {
      continue;
    }
    try {
      listener_({source.id_, static_cast<TaskState>(number - 1), task->error_message()});
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "events", std::string("a listener threw: ") + exception.what());
    }
  }
}

}  // namespace segue::task_host::detail
