// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/action_runner.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace segue::mission::detail {

struct Activation;

/// The end of an execution, on its way to the engine.
struct CompletionMessage {
  Activation* activation = nullptr;
  std::uint64_t generation = 0;
  Ending ending;
  std::vector<type::Value> outputs;
};

/// Messages from other threads to an engine. Thread safe. Completers share it, so it may outlive the engine.
class Mailbox {
 public:
  void post(CompletionMessage completion) {
    const Lock guard(mutex_);
    completions_.push_back(std::move(completion));
    changed();
  }
  void request_pause() {
    const Lock guard(mutex_);
    pause_ = true;
    changed();
  }
  void request_stop() {
    const Lock guard(mutex_);
    stop_ = true;
    changed();
  }
  /// Has the engine's thread carry out `task`, between two steps.
  void request(std::function<void()> task) {
    const Lock guard(mutex_);
    tasks_.push_back(std::move(task));
    changed();
  }

  /// Whether take() would return anything. Takes no lock: the engine asks before every step. Pairs with MB1.
  [[nodiscard]] bool has_messages() const { return pending_.load(std::memory_order_acquire); }

  struct Messages {
    std::vector<CompletionMessage> completions;
    std::vector<std::function<void()>> tasks;
    bool pause = false;
    bool stop = false;
  };
  Messages take() {
    const Lock guard(mutex_);
    Messages messages{std::move(completions_), std::move(tasks_), pause_, stop_};
    completions_.clear();
    tasks_.clear();
    pause_ = stop_ = false;
    pending_.store(false, std::memory_order_release);
    return messages;
  }

  /// Blocks until a message has arrived or, in real time, until `deadline`; without one, until a message
  /// arrives.
  void wait(std::optional<TimePoint> deadline) {
    Lock guard(mutex_);
    const auto arrived = [this] { return has_messages(); };
    if (deadline) {
      arrived_.wait_until(mutex_, *deadline, arrived);
    } else {
      arrived_.wait(mutex_, arrived);
    }
  }

 private:
  /// MB1: the store releases what was written before it to whoever sees has_messages() without the lock; the
  /// messages themselves are read under the lock.
  void changed() {
    pending_.store(true, std::memory_order_release);  // MB1
    arrived_.notify_all();
  }

  Mutex mutex_;  ///< guards all below; `pending_` is written under it and read without it
  ConditionVariable arrived_;
  std::atomic<bool> pending_{false};
  std::vector<CompletionMessage> completions_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::function<void()>> tasks_ SEGUE_GUARDED_BY(mutex_);
  bool pause_ SEGUE_GUARDED_BY(mutex_) = false;
  bool stop_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::mission::detail
