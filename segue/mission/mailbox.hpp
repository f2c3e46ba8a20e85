// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

namespace segue::mission::detail {

struct Activation;

/// The end of an execution, on its way to the engine.
struct Letter {
  Activation* activation = nullptr;
  std::uint64_t generation = 0;
  Ending ending;
  std::vector<type::Value> outputs;
};

/// What other threads tell an engine. Thread safe; outlives the engine in the hands of completers.
class Mailbox {
 public:
  void post(Letter letter) {
    const std::lock_guard guard(mutex_);
    letters_.push_back(std::move(letter));
    changed();
  }
  void request_pause() {
    const std::lock_guard guard(mutex_);
    pause_ = true;
    changed();
  }
  void request_stop() {
    const std::lock_guard guard(mutex_);
    stop_ = true;
    changed();
  }

  /// Cheap: whether take() would give anything.
  [[nodiscard]] bool has_news() const { return news_.load(std::memory_order_acquire); }

  struct News {
    std::vector<Letter> letters;
    bool pause = false;
    bool stop = false;
  };
  News take() {
    const std::lock_guard guard(mutex_);
    News news{std::move(letters_), pause_, stop_};
    letters_.clear();
    pause_ = stop_ = false;
    news_.store(false, std::memory_order_release);
    return news;
  }

  /// Blocks until there are news or, in real time, `deadline`; for ever without one.
  void wait(std::optional<TimePoint> deadline) {
    std::unique_lock guard(mutex_);
    const auto told = [this] { return has_news(); };
    if (deadline) {
      arrived_.wait_until(guard, *deadline, told);
    } else {
      arrived_.wait(guard, told);
    }
  }

 private:
  void changed() {
    news_.store(true, std::memory_order_release);
    arrived_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::atomic<bool> news_{false};
  std::vector<Letter> letters_;
  bool pause_ = false;
  bool stop_ = false;
};

}  // namespace segue::mission::detail
