// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/has_answered.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission_script/script_robot.hpp>

#include <segue/base/question.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/execution_threads.hpp>
#include <segue/mission_robot/change_watch.hpp>
#include <segue/mission_robot/robot_poll.hpp>
#include <segue/mission_script/script_messages.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <stop_token>
#include <system_error>
#include <utility>

namespace segue::mission {

using type::Value;
using type::ValueMap;

namespace {

/// The most requests of one execution at the same time: a script can have threads.
constexpr std::size_t kMostAsked = 64;
constexpr double kLongestTimeout = 24 * 3600;
constexpr Duration kAnswer = std::chrono::seconds(10);

ValueMap answer_of(Result<Value> result) {
  ValueMap answer;
  if (result) {
    answer.append("value", std::move(*result));
  } else {
    answer.append("error", result.error().message);
    answer.append("code", std::string(to_string(result.error().code)));
  }
  return answer;
}

Result<Value> nothing_of(const Result<void>& result) {
  if (!result) return result.error();
  return Value();
}

Value value_at(const Value& request, std::string_view key) {
  const Value* value = request.find(key);
  return value == nullptr ? Value() : *value;
}

TimePoint deadline_of(const Value& request) {
  const Value* timeout = request.find("timeout");
  const bool is_number =
      timeout != nullptr && (timeout->is_integer() || timeout->kind() == Value::Kind::Float);
  const double seconds = is_number ? timeout->as_double() : 0;
  const double kept = std::isfinite(seconds) ? std::clamp(seconds, 0.0, kLongestTimeout) : 0;
  return RealClock::instance().now() +
         std::chrono::duration_cast<Duration>(std::chrono::duration<double>(kept));
}

Result<Member> member_of(const Value& request) {
  const std::string name = text_at(request, "name");
  Member member = parse_member(name);
  if (!member.task.empty()) return member;
  return fail(ErrorCode::InvalidArgument, quote(name) + " is not of the form 'task.name'");
}

Result<std::vector<MemberValue>> properties_of(const Value& request) {
  std::vector<MemberValue> properties;
  const Value* set = request.find("set");
  if (set == nullptr || !set->is_map()) return properties;
  for (const auto& [name, value] : set->as_map()) {
    Member member = parse_member(name);
    if (member.task.empty())
      return fail(ErrorCode::InvalidArgument, quote(name) + " is not of the form 'task.property'");
    properties.push_back({std::move(member), value, {}});
  }
  return properties;
}

/// One execution of a script.
class RobotUse final : public ScriptRobot::Use {
 public:
  RobotUse(std::shared_ptr<CommandedRobot> robot, std::shared_ptr<ControllerUnion> controllers,
           const ScriptRobotOptions& options, ExecutionThreads& threads, ScriptRobot::Rights rights,
           std::function<void()> preempt)
      : robot_(std::move(robot)),
        controllers_(std::move(controllers)),
        options_(options),
        threads_(threads),
        rights_(std::move(rights)),
        preempt_(std::move(preempt)) {}

  void ask(Value request, ScriptRobot::Answered answered) override {
    const std::stop_source stop;
    if (auto accepted = accept(request, stop); !accepted) return answered(answer_of(accepted.error()));
    try {
      threads_.start(stop, [self = shared(), request, answered](const std::stop_token& stopped) {
        ValueMap answer = answer_of(self->carry_out(request, stopped));
        self->has_answered(request, stopped);
        answered(std::move(answer));
      });
    } catch (const std::system_error& failed) {
      has_answered(request, stop.get_token());
      answered(answer_of(fail(ErrorCode::ResourceExhausted, std::string("no thread: ") + failed.what())));
    }
  }

  void preempt() override {
    std::vector<std::stop_source> asked;
    {
      const Lock lock(mutex_);
      preempted_ = true;
      asked = asked_;
    }
    for (std::stop_source& one : asked)
      one.request_stop();
  }

  void end(Ending ending, std::function<void(Ending)> ended) override {
    preempt();
    bool has_nothing = false;
    {
      const Lock lock(mutex_);
      has_ended_ = true;
      watch_.request_stop();
      has_nothing = requests_ == 0 && used_.empty() && !lost_;
    }
    if (has_nothing) return ended(std::move(ending));
    const auto give_back = [self = shared(), ending, ended](const std::stop_token&) {
      ended(self->give_back(ending));
    };
    try {
      threads_.start({}, give_back);
    } catch (const std::system_error&) {
      give_back({});
    }
  }

 private:
  struct Used {
    std::string controller;
    bool keep = true;
  };
  /// Several threads of a script may read the same port.
  struct Feed {
    explicit Feed(PortFeed opened) : port(std::move(opened)) {}
    Mutex mutex;
    PortFeed port SEGUE_GUARDED_BY(mutex);
  };

  std::shared_ptr<RobotUse> shared() { return std::static_pointer_cast<RobotUse>(shared_from_this()); }

  /// Counted from here on, so that the end of the execution waits for it.
  Result<void> accept(const Value& request, const std::stop_source& stop) {
    const Lock lock(mutex_);
    if (has_ended_) return fail(ErrorCode::InvalidState, "the action has ended");
    if (asked_.size() >= kMostAsked) return fail(ErrorCode::ResourceExhausted, "it asks too much at once");
    asked_.push_back(stop);
    if (text_at(request, "call") == "request") ++requests_;
    return {};
  }

  void has_answered(const Value& request, const std::stop_token& stop) {
    const Lock lock(mutex_);
    std::erase_if(asked_, [&](const std::stop_source& one) { return one.get_token() == stop; });
    if (text_at(request, "call") == "request") --requests_;
    answered_.notify_all();
  }

  Result<Value> carry_out(const Value& request, const std::stop_token& stop) {
    {
      const Lock lock(mutex_);
      if (lost_) return fail(ErrorCode::Unavailable, lost_->error);
    }
    auto result = serve(request, stop);
    if (!result && options_.unreachable) {
      if (const auto reached = robot_->trouble("", Wait(TimePoint::max())); !reached)
        lose_robot(reached.error());
    }
    return result;
  }

  Result<Value> serve(const Value& request, const std::stop_token& stop) {
    const std::string call = text_at(request, "call");
    if (call == "task") return task(request, stop);
    if (call == "wait_for_state") return wait_for_state(request, stop);
    if (call == "request" || call == "set" || call == "write") {
      if (!rights_.may_command)
        return fail(ErrorCode::PermissionDenied, "a sensing action can only look at the robot");
    }
    const bool only_looks = call == "read" || call == "release";
    if (!only_looks && is_preempted())
      return fail(ErrorCode::Cancelled, "the action was preempted and commands nothing any more");
    if (call == "request") return this->request(request, stop);
    if (call == "release") return release(request);
    const auto member = member_of(request);
    if (!member) return member.error();
    if (call == "read") {
      return poll(member->task, {deadline_of(request), stop},
                  [&](const Wait& wait) { return read(*member, wait.deadline, wait.stop); });
    }
    const Value value = value_at(request, "value");
    const Wait wait(deadline_of(request), stop);
    if (call == "call") return robot_->call(*member, value, wait);
    if (call == "set") {
      const auto done = robot_->set(*member, value, wait);
      controllers_->note_changed();
      return nothing_of(done);
    }
    if (call == "write") return nothing_of(robot_->write(*member, value, wait));
    return fail(ErrorCode::Unsupported, "a robot has no operation " + quote(call));
  }

  bool is_preempted() {
    const Lock lock(mutex_);
    return preempted_;
  }

  Result<Value> task(const Value& request, const std::stop_token& stop) {
    const std::string name = text_at(request, "name");
    return poll(name, {RealClock::instance().now() + kAnswer, stop}, [&](const Wait& wait) {
      const auto view = robot_->task(name, wait);
      return view ? to_value(*view) : Result<Value>(view.error());
    });
  }

  /// The answer of `question` about a task. Where the task was lost that the script has seen before, asks
  /// again while the robot repairs it.
  template <class Question>
  Result<Value> poll(const std::string& task, const Wait& wait, Question question) {
    auto got = question(wait);
    TimePoint give_up = RealClock::instance().now() + options_.notice;
    while (!got && may_be_lost(got.error()) && has_seen(task) && !wait.is_stopped()) {
      if (is_mended(wait.stop)) give_up = RealClock::instance().now() + options_.notice;
      if (RealClock::instance().now() >= std::min(give_up, wait.deadline)) return got;
      wait_for_next_poll(options_.period, wait.stop);
      got = question(wait);
    }
    if (got) note_seen(task);
    return got;
  }
  void note_seen(const std::string& task) {
    const Lock lock(mutex_);
    seen_.insert(task);
  }
  bool has_seen(const std::string& task) {
    const Lock lock(mutex_);
    return seen_.contains(task);
  }
  /// Whether the robot is mending a part of a controller that the script uses.
  bool is_mended(const std::stop_token& stop) {
    std::vector<Used> used;
    {
      const Lock lock(mutex_);
      used = used_;
    }
    return std::ranges::any_of(used, [&](const Used& one) {
      const auto trouble = robot_->trouble(one.controller, Wait(TimePoint::max(), stop));
      return trouble && !trouble->repair.empty();
    });
  }

  static Value to_value(const TaskView& view) {
    return Value::map({{"state", view.state}, {"state_name", view.state_name}, {"updates", view.updates}});
  }

  /// The task, once it has been updated since and is in that state.
  Result<Value> wait_for_state(const Value& request, const std::stop_token& stop) {
    const std::string name = text_at(request, "name");
    const TaskReaches wanted{name, text_at(request, "state")};
    const TimePoint deadline = request.find("timeout") == nullptr ? TimePoint::max() : deadline_of(request);
    return poll(name, {deadline, stop}, [&](const Wait& wait) { return reaches(wanted, wait); });
  }

  Result<Value> reaches(const TaskReaches& wanted, const Wait& wait) {
    auto view = robot_->task(wanted.task, {RealClock::instance().now() + kAnswer, wait.stop});
    const std::uint64_t updates = view ? view->updates : 0;
    if (view) note_seen(wanted.task);
    while (view) {
      const bool is_there = is_in(*view, wanted);
      if (is_there && (view->updates > updates || view->state != "running")) return to_value(*view);
      if (RealClock::instance().now() >= wait.deadline) {
        const std::string& state = view->state_name.empty() ? view->state : view->state_name;
        return fail(ErrorCode::DeadlineExceeded,
                    "the task was not " + wanted.state + " in time, but " + state);
      }
      view = changed_from({wanted.task, *view, is_there}, wait.deadline, wait.stop);
    }
    return view.error();
  }

  /// How a task is once that is news, and from time to time.
  Result<TaskView> changed_from(const TaskQuestion& question, TimePoint deadline,
                                const std::stop_token& stop) {
    const TimePoint until = std::min(deadline, RealClock::instance().now() + kAnswer);
    return answer_to<TaskView>(Wait(until + kAnswer, stop), [&](const Wait& asked, TaskAnswer answer) {
      robot_->watch(question, Wait(until, asked.stop), std::move(answer));
    });
  }

  /// A sample that came since the last call for that port; waits for one.
  Result<Value> read(const Member& port, TimePoint deadline, const std::stop_token& stop) {
    const auto feed = feed_of(port, {deadline, stop});
    if (!feed) return feed.error();
    const Lock reading((*feed)->mutex);
    const auto came = (*feed)->port.next({deadline, stop});
    if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "it was preempted");
    if (!came) {
      const Lock lock(mutex_);
      feeds_.erase(to_string(port));  // opened anew by the next call
      return came.error();
    }
    if ((*feed)->port.fresh.empty())
      return fail(ErrorCode::DeadlineExceeded, "no sample came from " + to_string(port));
    return (*feed)->port.fresh.back();
  }

  Result<std::shared_ptr<Feed>> feed_of(const Member& port, const Wait& wait) {
    {
      const Lock lock(mutex_);
      if (const auto found = feeds_.find(to_string(port)); found != feeds_.end()) return found->second;
    }
    auto opened = PortFeed::open(*robot_, port, wait);
    if (!opened) return opened.error();
    const Lock lock(mutex_);
    auto& feed = feeds_[to_string(port)];
    if (!feed) feed = std::make_shared<Feed>(std::move(*opened));
    return feed;
  }

  Result<Value> request(const Value& request, const std::stop_token& stop) {
    const std::string controller = text_at(request, "name");
    if (std::ranges::find(rights_.controllers, controller) == rights_.controllers.end()) {
      return fail(ErrorCode::PermissionDenied, "the action does not declare that it uses the controller " +
                                                   quote(controller) + "; add it to its 'controllers'");
    }
    auto properties = properties_of(request);
    if (!properties) return properties.error();
    const bool keep = text_at(request, "afterwards") != "stop";
    if (auto runs = controllers_->begin(controller, std::move(*properties), {rights_.user, stop, keep});
        !runs)
      return runs.error();
    const Lock lock(mutex_);
    const auto found = std::ranges::find(used_, controller, &Used::controller);
    if (found == used_.end()) {
      used_.push_back({controller, keep});
      uses_more_ = true;
      bell_->ring();
    } else {
      found->keep = keep;
      (void)controllers_->end(controller, true);  // counted once
    }
    if (std::exchange(is_watched_, true)) return Value();
    try {
      threads_.start(watch_, [self = shared()](const std::stop_token& end) { self->watch(end); });
    } catch (const std::system_error& failed) {
      return fail(ErrorCode::ResourceExhausted, std::string("no thread: ") + failed.what());
    }
    return Value();
  }

  Result<Value> release(const Value& request) {
    const std::string controller = text_at(request, "name");
    Lock lock(mutex_);
    const auto found = std::ranges::find(used_, controller, &Used::controller);
    if (found == used_.end())
      return fail(ErrorCode::InvalidState, "the action does not use the controller " + quote(controller));
    const Used used = *found;
    used_.erase(found);
    lock.unlock();
    return nothing_of(controllers_->end(used.controller, used.keep, rights_.user));
  }

  void watch(const std::stop_token& stop) {
    ChangeWatch changes(*robot_, bell_);
    while (!stop.stop_requested()) {
      changes.ask();
      const bool uses_more = uses_more_.exchange(false);
      if ((changes.take() || uses_more) && look_after_controllers(stop)) return preempt_();
      bell_->wait({changes.next_question(), stop});
    }
  }

  /// Whether the robot does not run one of them as it should; notes what the execution comes to then.
  bool look_after_controllers(const std::stop_token& stop) {
    std::vector<Used> used;
    {
      const Lock lock(mutex_);
      if (lost_) return true;
      used = used_;
    }
    for (const Used& one : used) {
      const auto trouble = robot_->trouble(one.controller, Wait(TimePoint::max(), stop));
      if (!trouble) {
        if (stop.stop_requested()) return false;
        if (options_.unreachable) return lose_robot(trouble.error()), true;
        return lose({kAborted, to_string(trouble.error())}), true;
      }
      auto ending = ending_by(*trouble, one.controller, {});
      if (ending && uses(one.controller)) return lose(std::move(*ending)), true;
    }
    return false;
  }

  bool uses(const std::string& controller) {
    const Lock lock(mutex_);
    return std::ranges::find(used_, controller, &Used::controller) != used_.end();
  }

  void lose(Ending ending) {
    const Lock lock(mutex_);
    if (!lost_) lost_ = std::move(ending);
  }

  /// The robot cannot be reached any more: the run ends as one that can be resumed.
  void lose_robot(const Error& why) {
    lose({kPreempted, to_string(why)});
    options_.unreachable(why);
  }

  /// Waits for requests under way.
  Ending give_back(Ending ending) {
    Lock lock(mutex_);
    answered_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return requests_ == 0; });
    lock.unlock();
    if (ending.outcome != kPreempted) (void)look_after_controllers({});
    lock.lock();
    const std::vector<Used> used = std::exchange(used_, {});
    if (lost_) ending = *lost_;
    lock.unlock();
    for (const Used& one : used) {
      const auto ended = controllers_->end(one.controller, one.keep, rights_.user);
      if (!ended && ending.outcome >= 0) ending = {kAborted, to_string(ended.error())};
    }
    return ending;
  }

  const std::shared_ptr<CommandedRobot> robot_;
  const std::shared_ptr<ControllerUnion> controllers_;
  const ScriptRobotOptions& options_;
  ExecutionThreads& threads_;
  const ScriptRobot::Rights rights_;
  const std::function<void()> preempt_;

  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();  ///< of what watches the controllers
  std::atomic<bool> uses_more_ = false;  ///< since it last looked at them; set before the bell rings

  Mutex mutex_;  ///< protects all below; not held while the robot is asked
  ConditionVariable answered_;
  std::vector<std::stop_source> asked_ SEGUE_GUARDED_BY(mutex_);
  std::size_t requests_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< for controllers, that are under way
  std::vector<Used> used_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, std::shared_ptr<Feed>> feeds_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> seen_ SEGUE_GUARDED_BY(mutex_);  ///< tasks that it has looked at
  std::stop_source watch_ SEGUE_GUARDED_BY(mutex_);
  bool is_watched_ SEGUE_GUARDED_BY(mutex_) = false;
  bool preempted_ SEGUE_GUARDED_BY(mutex_) = false;
  bool has_ended_ SEGUE_GUARDED_BY(mutex_) = false;
  std::optional<Ending> lost_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace

ScriptRobot::ScriptRobot(std::shared_ptr<CommandedRobot> robot, std::shared_ptr<ControllerUnion> controllers,
                         ScriptRobotOptions options)
    : robot_(std::move(robot)),
      controllers_(std::move(controllers)),
      options_(std::move(options)),
      threads_(std::make_unique<ExecutionThreads>()) {}
ScriptRobot::~ScriptRobot() = default;

std::shared_ptr<ScriptRobot::Use> ScriptRobot::begin(Rights rights, std::function<void()> preempt) {
  return std::make_shared<RobotUse>(robot_, controllers_, options_, *threads_, std::move(rights),
                                    std::move(preempt));
}

}  // namespace segue::mission
