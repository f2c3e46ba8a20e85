// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/error.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

/// Questions that are answered later, by another thread, to whoever waits for several of them at once.
namespace segue {

/// Wakes one thread. ring() may be called from any thread.
class Bell {
 public:
  void ring() {
    const Lock lock(mutex_);
    rung_ = true;
    changed_.notify_all();
  }
  /// Waits until the bell has been rung since the last call, or the wait ends.
  void wait(const Wait& wait) {
    Lock lock(mutex_);
    changed_.wait_until(mutex_, wait.stop, wait.deadline, [this]() SEGUE_REQUIRES(mutex_) { return rung_; });
    rung_ = false;
  }

 private:
  Mutex mutex_;
  StoppableConditionVariable changed_;
  bool rung_ SEGUE_GUARDED_BY(mutex_) = false;
};

/// One question at a time. The answer rings a bell and is kept until it is taken. One thread uses this.
template <class T>
class Question {
 public:
  using Answer = std::function<void(Result<T>)>;

  explicit Question(std::shared_ptr<Bell> bell) : bell_(std::move(bell)) {}
  Question(Question&&) noexcept = default;
  Question& operator=(Question&&) = delete;
  ~Question() { stop_.request_stop(); }

  /// `ask(wait, answer)` must have `answer` called once, by any thread. Requires that nothing is asked.
  template <class Ask>
  void ask(TimePoint deadline, const Ask& ask) {
    stop_ = std::stop_source();
    slot_ = std::make_shared<Slot>();
    ask(Wait(deadline, stop_.get_token()), Answer([slot = slot_, bell = bell_](Result<T> answer) {
          {
            const Lock lock(slot->mutex);
            slot->answer = std::move(answer);
          }
          bell->ring();
        }));
  }
  [[nodiscard]] bool is_asked() const { return slot_ != nullptr; }
  /// The answer, if it has come; then another question may be asked.
  std::optional<Result<T>> take() {
    if (!slot_) return std::nullopt;
    std::optional<Result<T>> answer;
    {
      const Lock lock(slot_->mutex);
      answer = std::move(slot_->answer);
    }
    if (answer) slot_.reset();
    return answer;
  }

 private:
  struct Slot {
    Mutex mutex;
    std::optional<Result<T>> answer SEGUE_GUARDED_BY(mutex);
  };
  std::shared_ptr<Bell> bell_;
  std::stop_source stop_;
  std::shared_ptr<Slot> slot_;
};

/// Asks and waits for the answer; `ask` as of Question::ask().
template <class T, class Ask>
Result<T> answer_to(const Wait& wait, const Ask& ask) {
  const auto bell = std::make_shared<Bell>();
  Question<T> question(bell);
  question.ask(wait.deadline, ask);
  while (true) {
    if (auto answer = question.take()) return std::move(*answer);
    if (wait.is_stopped()) return no_longer_wanted();
    if (RealClock::instance().now() >= wait.deadline)
      return fail(ErrorCode::DeadlineExceeded, "no answer has come in time");
    bell->wait(wait);
  }
}

/// Answers exactly once: with the first result that it is called with, or with an error where there was none
/// when its last copy ends.
template <class T>
class SureAnswer {
 public:
  SureAnswer(std::function<void(Result<T>)> answer, Error otherwise)
      : state_(std::make_shared<State>(std::move(answer), std::move(otherwise))) {}
  void operator()(Result<T> result) const {
    if (auto answer = std::exchange(state_->answer, nullptr)) answer(std::move(result));
  }

 private:
  struct State {
    State(std::function<void(Result<T>)> to, Error error)
        : answer(std::move(to)), otherwise(std::move(error)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      if (answer) answer(otherwise);
    }
    std::function<void(Result<T>)> answer;
    Error otherwise;
  };
  std::shared_ptr<State> state_;
};

}  // namespace segue
