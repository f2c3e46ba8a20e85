// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/condition_watch.hpp>

#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <variant>

namespace segue::runtime::detail {

namespace {

constexpr std::size_t kBuffer = 64;
constexpr Duration kBetweenCalls = std::chrono::milliseconds(10);

TimePoint now() {
  return RealClock::instance().now();
}

}  // namespace

ConditionWatch::ConditionWatch(host::TaskHost& host, model::RobotCondition condition, From from,
                               std::function<void()> changed)
    : host_(host),
      condition_(std::move(condition)),
      from_(from),
      changed_(std::move(changed)),
      thread_(concurrent::start_thread("segue-watch", [this] { work(stop_.get_token()); })) {}

ConditionWatch::~ConditionWatch() {
  stop_.request_stop();
  thread_.join();
}

void ConditionWatch::work(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  while (!stop.stop_requested()) {
    const bool seen = look();
    if (holds_.exchange(seen) != seen) {
      changed_();
    }
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, kPeriod, [] { return false; });
  }
}

bool ConditionWatch::look() {
  return std::visit([this](const auto& when) { return look(when); }, condition_);
}

bool ConditionWatch::look(const model::TaskReaches& when) {
  const auto report = host_.report(model::TaskId(when.task), now() + kLook);
  if (!report) {
    first_cycle_.reset();
    return false;
  }
  if (!first_cycle_) {
    first_cycle_ = report->timing.cycles;
  }
  const bool is_new =
      from_ == From::Now || report->state != TaskState::Running || report->timing.cycles != *first_cycle_;
  return is_new && (to_string(report->state) == when.state || report->state_name == when.state);
}

/// The last sample counts until the next one, and each that came between two looks.
bool ConditionWatch::look(const model::SampleShows& when) {
  if (!reader_) {
    auto opened = host_.open_reader({model::TaskId(when.port.task), when.port.name}, kBuffer);
    if (!opened) {
      return false;
    }
    reader_ = std::move(*opened);
    last_.reset();
  }
  if (!host_.report(model::TaskId(when.port.task), now() + kLook)) {
    reader_.reset();  // its task is gone
    return false;
  }
  const auto samples = reader_->read(kBuffer);
  if (!samples.empty()) {
    last_ = samples.back();
  }
  return (last_ && model::holds(when.what, *last_)) ||
         std::ranges::any_of(samples,
                             [&](const type::Value& sample) { return model::holds(when.what, sample); });
}

bool ConditionWatch::look(const model::OperationAnswers& when) {
  if (now() < next_call_) {
    return holds_;
  }
  next_call_ = now() + kBetweenCalls;
  const auto answer =
      host_.call(model::TaskId(when.operation.task), when.operation.name, type::ValueMap{}, now() + kLook);
  return answer && *answer == when.is;
}

}  // namespace segue::runtime::detail
