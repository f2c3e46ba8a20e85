// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/condition_watch.hpp>

#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <utility>
#include <variant>

namespace segue::runtime::detail {

namespace {

constexpr std::size_t kBuffer = 64;

TimePoint now() {
  return RealClock::instance().now();
}

}  // namespace

ConditionWatch::ConditionWatch(task_host::TaskHost& host, model::RobotCondition condition, From from,
                               std::function<void()> changed)
    : host_(host),
      condition_(std::move(condition)),
      from_(from),
      changed_(std::move(changed)),
      thread_(concurrent::start_thread("segue-condition", [this] { work(stop_.get_token()); })) {}

ConditionWatch::~ConditionWatch() {
  stop_.request_stop();
  thread_.join();
}

void ConditionWatch::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    next_poll_ = TimePoint::max();
    const bool seen = poll();
    if (holds_.exchange(seen) != seen) {
      changed_();
    }
    bell_->wait({next_poll_, stop});
  }
}

bool ConditionWatch::follow(const std::string& task, Updates updates) {
  auto answer = question_.take();
  if (answer && *answer) {
    level_ = std::move(**answer);
    first_update_ = first_update_.value_or(level_->updates);
  } else if (answer) {
    level_.reset();
    first_update_.reset();
    ask_at_ = now() + kAgain;
  }
  if (!question_.is_asked() && now() >= ask_at_) {
    const bool each = updates == Updates::Each || (updates == Updates::First && !has_news());
    question_.ask(now() + kPatience, [&](const Wait& wait, task_host::LevelAnswer answered) {
      host_.watch({model::TaskId(task), level_, each}, wait, std::move(answered));
    });
  }
  if (!question_.is_asked()) {
    next_poll_ = std::min(next_poll_, ask_at_);
  }
  return answer.has_value();
}

/// Whether what the task says counts.
bool ConditionWatch::has_news() const {
  return level_ &&
         (from_ == From::Now || level_->state != TaskState::Running || level_->updates != *first_update_);
}

bool ConditionWatch::poll() {
  return std::visit([this](const auto& when) { return poll(when); }, condition_);
}

bool ConditionWatch::poll(const model::TaskReaches& when) {
  follow(when.task, Updates::First);
  return has_news() && (to_string(level_->state) == when.state || level_->state_name == when.state);
}

bool ConditionWatch::has_reader(const model::Member& port) {
  if (!reader_ && now() >= read_at_) {
    auto opened = host_.open_reader({model::TaskId(port.task), port.name}, kBuffer);
    if (opened) {
      reader_ = std::move(*opened);
    }
    last_.reset();
    read_at_ = now() + (opened ? Duration(0) : kAgain);
  }
  return reader_ != nullptr;
}

std::vector<type::Value> ConditionWatch::take_samples() {
  auto answer = samples_.take();
  if (answer && !*answer) {
    reader_.reset();  // its task is gone, or its process
    last_.reset();
    read_at_ = now() + kAgain;
    return {};
  }
  if (!samples_.is_asked() && now() >= read_at_) {
    read_at_ = now() + kBetweenSamples;
    samples_.ask(now() + kPatience, [&](const Wait& wait, task_host::SamplesAnswer answered) {
      reader_->next(kBuffer, wait, std::move(answered));
    });
  }
  return answer ? std::move(**answer) : std::vector<type::Value>();
}

/// The last sample counts until the next one, and each that came between two looks.
bool ConditionWatch::poll(const model::SampleShows& when) {
  const auto samples = has_reader(when.port) ? take_samples() : std::vector<type::Value>();
  if (!samples_.is_asked()) {
    next_poll_ = std::min(next_poll_, read_at_);
  }
  if (!samples.empty()) {
    last_ = samples.back();
  }
  return (last_ && model::holds(when.what, *last_)) ||
         std::ranges::any_of(samples,
                             [&](const type::Value& sample) { return model::holds(when.what, sample); });
}

bool ConditionWatch::poll(const model::OperationAnswers& when) {
  is_due_ = follow(when.operation.task, Updates::Each) || is_due_;
  if (!is_due_ || now() < next_call_) {
    next_poll_ = std::min(next_poll_, is_due_ ? next_call_ : TimePoint::max());
    return holds_;
  }
  is_due_ = false;
  ask_at_ = next_call_ = now() + kBetweenCalls;
  const auto answer =
      host_.call(model::TaskId(when.operation.task), when.operation.name, type::ValueMap{}, now() + kCall);
  return answer && *answer == when.is;
}

}  // namespace segue::runtime::detail
