// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/task_requests.hpp>

#include <segue/base/question.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

namespace {

constexpr Duration kPatience = std::chrono::milliseconds(500);  ///< how long a question waits for an update
constexpr Duration kCall = std::chrono::milliseconds(200);
constexpr Duration kAgain = std::chrono::milliseconds(10);  ///< after what could not be asked

TimePoint time_now() {
  return RealClock::instance().now();
}

/// The tasks whose outputs are connected to that one: "task handler", "tasks a and b".
std::string writers_to(const model::TaskId& task, const model::Network& controller) {
  std::set<std::string> writers;
  for (const model::Connection& connection : controller.connections) {
    if (connection.to.task == task) writers.insert(connection.from.task.str());
  }
  if (writers.empty()) writers.insert(task.str());
  return (writers.size() == 1 ? "task " : "tasks ") +
         listed(std::vector<std::string>(writers.begin(), writers.end()));
}

}  // namespace

/// Watches one task of the component runtime::Requests.
class RequestWatch {
 public:
  struct Ways {
    task_host::TaskHost& host;
    EventLog& log;
    const TaskRequests::Request& request;
  };
  /// `is_late`: what it says first was requested under another runtime.
  RequestWatch(Ways ways, model::TaskId task, std::string who, bool is_late)
      : ways_(ways),
        task_(std::move(task)),
        who_(std::move(who)),
        is_late_(is_late),
        thread_(concurrent::start_thread("segue-requests", [this] { work(stop_.get_token()); })) {}
  ~RequestWatch() {
    stop_.request_stop();
    thread_.join();
  }
  RequestWatch(const RequestWatch&) = delete;
  RequestWatch& operator=(const RequestWatch&) = delete;

  void set_who(std::string who) {
    const Lock lock(mutex_);
    who_ = std::move(who);
  }

 private:
  void work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (auto answer = question_.take()) {
        level_ = *answer ? std::optional(std::move(**answer)) : std::nullopt;
        if (!level_ || !take_requests(stop)) {
          level_.reset();
          ask_at_ = time_now() + kAgain;
        }
      }
      if (!question_.is_asked() && time_now() >= ask_at_) {
        question_.ask(time_now() + kPatience, [this](const Wait& wait, task_host::LevelAnswer answered) {
          ways_.host.watch({task_, level_, true}, wait, std::move(answered));
        });
      }
      bell_->wait({question_.is_asked() ? TimePoint::max() : ask_at_, stop});
    }
  }

  /// Requests what the task says; false where it could not be asked.
  bool take_requests(const std::stop_token& stop) {
    const auto answer =
        ways_.host.call(task_, "requests", type::Value::map({{"after", number_}}), time_now() + kCall);
    const type::Value* last = answer ? answer->find("last") : nullptr;
    const type::Value* controllers = answer ? answer->find("controllers") : nullptr;
    const bool fits =
        last != nullptr && last->is_integer() && controllers != nullptr && controllers->is_list();
    if (!fits) return false;
    const auto newest = static_cast<std::uint64_t>(last->as_int());
    if (newest < number_) {  // the task has moved to another computer, whose clock it numbers by
      number_ = 0;
      return false;
    }
    for (const type::Value& controller : controllers->as_list()) {
      if (!stop.stop_requested() && controller.is_string()) request(controller.as_string());
    }
    number_ = newest;
    is_late_ = false;
    return true;
  }

  void request(const std::string& controller) {
    std::string who;
    {
      const Lock lock(mutex_);
      who = who_;
    }
    if (!is_late_) return ways_.request(controller, who);
    ways_.log.add(EventKind::RequestRefused, controller,
                  who + " requested it before this runtime began, so it is too late");
  }

  const Ways ways_;
  const model::TaskId task_;
  Mutex mutex_;
  std::string who_ SEGUE_GUARDED_BY(mutex_);
  // Of the thread:
  bool is_late_;
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  segue::Question<task_host::TaskLevel> question_{bell_};
  std::optional<task_host::TaskLevel> level_;  ///< nothing: it is asked as it is now
  std::uint64_t number_ = 0;                   ///< of the last request that was taken
  TimePoint ask_at_{};                         ///< not before then
  std::stop_source stop_;
  std::thread thread_;
};

TaskRequests::TaskRequests(task_host::TaskHost& host, EventLog& log, Request request)
    : host_(host), log_(log), request_(std::move(request)) {}

TaskRequests::~TaskRequests() {
  end();
}

void TaskRequests::end() {
  const Lock lock(mutex_);
  has_ended_ = true;
  watches_.clear();
}

void TaskRequests::look_at(const model::Network& controller) {
  const auto makes_requests = [](const model::Task& task) {
    return task.component.str() == kComponent && task.state == TaskState::Running;
  };
  const Lock lock(mutex_);
  const bool is_late = std::exchange(is_first_look_, false);
  if (has_ended_) return;
  std::map<model::TaskId, std::unique_ptr<RequestWatch>> before = std::exchange(watches_, {});
  if (before.empty() && std::ranges::none_of(controller.tasks, makes_requests)) return;
  const model::Network condensed = host_.condensed(controller);
  for (const model::Task& task : condensed.tasks) {
    if (!makes_requests(task)) continue;
    auto& watch = watches_[task.id] = std::move(before[task.id]);
    std::string who = writers_to(task.id, condensed);
    if (watch) {
      watch->set_who(std::move(who));
    } else {
      watch = std::make_unique<RequestWatch>(RequestWatch::Ways{host_, log_, request_}, task.id,
                                             std::move(who), is_late);
    }
  }
}

}  // namespace segue::runtime::detail
