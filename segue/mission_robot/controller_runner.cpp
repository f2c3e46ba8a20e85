// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/controller_runner.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/execution_threads.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission_robot/controller_progress.hpp>
#include <segue/mission_robot/prepared_controllers.hpp>
#include <segue/mission_robot/robot_poll.hpp>
#include <segue/mission_robot/task_commands.hpp>
#include <segue/mission_robot/upcoming_controllers.hpp>
#include <segue/mission_robot/watched_controller.hpp>
#include <segue/mission_robot/watched_ports.hpp>
#include <segue/mission_robot/watched_tasks.hpp>

#include <algorithm>
#include <atomic>
#include <map>
#include <stop_token>
#include <utility>

namespace segue::mission {

using type::Value;

namespace {

/// Operations of tasks that do not update are called again after this.
constexpr Duration kBetweenCallsWithoutUpdates = std::chrono::milliseconds(250);

TimePoint now() {
  return RealClock::instance().now();
}

ControllerUse filled(ControllerUse use, const ActionCall& call) {
  for (auto* values : {&use.set, &use.call, &use.write}) {
    for (MemberValue& one : *values)
      one.value = call.filled(one.value);
  }
  return use;
}

Ending aborted(const Error& error) {
  return {kAborted, to_string(error)};
}

/// The parts that all executions of a runner share.
struct Shared {
  Shared(std::shared_ptr<CommandedRobot> commanded, const ControllerOptions& given,
         std::shared_ptr<ControllerUnion> shared)
      : robot(std::move(commanded)),
        options(given),
        controllers(shared ? std::move(shared)
                           : std::make_shared<ControllerUnion>(
                                 robot, ControllerUnion::Options{.deadline = options.request_deadline})),
        prepared(robot, options.look_ahead, options.request_deadline) {}

  const std::shared_ptr<CommandedRobot> robot;
  const ControllerOptions options;
  const std::shared_ptr<ControllerUnion> controllers;
  PreparedControllers prepared;
};

/// One execution of an action, in a thread of its own.
class ControlledRun {
 public:
  struct Task {
    ControllerUse use;
    std::vector<Outcome> outcomes;           ///< of each of `use.until`
    std::vector<std::size_t> output_places;  ///< of each of `use.outputs`
    std::uint64_t number = 0;                ///< of the execution
    std::vector<UpcomingController> ahead{};
    ControllerProgress progress{};  ///< of an earlier run
    ControllerUser user{};
    std::function<void(const Value&)> record{};
  };

  ControlledRun(Shared& shared, Task task)
      : shared_(shared),
        robot_(*shared.robot),
        options_(shared.options),
        task_(std::move(task)),
        use_(task_.use),
        commands_(robot_, use_, options_.answer_deadline),
        is_told_(task_.progress.stage == ControllerProgress::Stage::Told),
        told_(task_.progress.updates) {
    if (is_told_) commands_.skip();
  }

  /// Blocks until the action has ended.
  Ending run(const std::stop_token& stop, std::vector<Value>& outputs) {
    if (!is_told_) {
      const auto runs = shared_.controllers->begin(use_.controller, use_.set, {task_.user, stop, !use_.stop});
      if (!runs) return stop.stop_requested() ? preempted() : failed(runs.error(), stop);
    }
    shared_.prepared.began(task_.number, use_.controller, std::move(task_.ahead));
    Ending ending = carry_out(stop, outputs);
    shared_.prepared.ended(task_.number);
    const auto ended = shared_.controllers->end(use_.controller, !use_.stop, task_.user);
    if (!ended && ending.outcome >= 0) return failed(ended.error(), stop);
    return ending;
  }

 private:
  Ending carry_out(const std::stop_token& stop, std::vector<Value>& outputs) {
    follow_tasks();
    tasks_.ask();  // so a task that begins anew while it is being told is noticed
    if (auto ending = tell_tasks(stop)) return *ending;
    begin_ = now();
    Ending ending = watch(stop);
    if (ending.outcome < 0) return ending;
    if (auto read = read_outputs(stop, outputs); !read) return aborted_by(read.error(), stop);
    return ending;
  }

  static Ending preempted() { return {kPreempted, {}}; }

  /// The ending with this error; where the controller is gone, that is the reason instead.
  Ending aborted_by(const Error& error, const std::stop_token& stop) {
    if (stop.stop_requested()) return preempted();
    if (auto lost = loss(stop)) return *lost;
    return aborted(error);
  }

  /// The ending with this error; without its robot, the run ends as one that can be resumed.
  Ending failed(const Error& error, const std::stop_token& stop) {
    if (!options_.unreachable || robot_.trouble(use_.controller, until(stop))) return aborted(error);
    options_.unreachable(error);
    while (!stop.stop_requested())
      wait(stop);
    return preempted();
  }

  void record(ControllerProgress::Stage stage) {
    task_.progress = {stage, use_.controller, use_.set, told_};
    if (task_.record) task_.record(task_.progress.to_value());
  }

  /// Tells its tasks what they have not been told, and waits for those that the robot mends meanwhile. The
  /// ending where they cannot be told.
  std::optional<Ending> tell_tasks(const std::stop_token& stop) {
    TimePoint give_up = now() + options_.notice;
    while (true) {
      // Before they are told, since some write a result once, at once.
      auto told = open_feeds(robot_, use_.outputs, outputs_, until(stop));
      if (told && !is_told_) told = tell(stop);
      if (told) told = open_ports(stop);
      if (told) return std::nullopt;
      if (auto ending = await_repair(told.error(), give_up, stop)) return ending;
      forget_begun_anew();
    }
  }

  /// Gives the commands to the tasks; from then on their states count.
  Result<void> tell(const std::stop_token& stop) {
    if (!commands_.are_given()) record(ControllerProgress::Stage::Tells);
    if (auto given = commands_.give(stop); !given) return given;
    for (const EndCondition& condition : use_.until) {
      const auto* reaches = condition_of<TaskReaches>(condition);
      if (reaches == nullptr || told_.contains(reaches->task)) continue;
      const auto task = robot_.task(reaches->task, {answer_by(), stop});
      if (!task) return task.error();
      told_.emplace(reaches->task, task->updates);
    }
    follow_tasks();
    is_told_ = true;
    record(ControllerProgress::Stage::Told);
    return {};
  }

  /// Tasks that have begun anew know nothing of what they were told; feeds of their ports have ended. False:
  /// none has.
  bool forget_begun_anew() {
    const auto anew = tasks_.take_begun_anew();
    for (const std::string& task : anew) {
      if (commands_.forget(task)) warn_of_telling_again(task);
      ports_.forget(task);
      for (auto& output : outputs_) {
        if (output && output->port.task == task) output.reset();
      }
      told_.erase(task);
      is_told_ = false;
    }
    return !anew.empty();
  }

  /// Logs that commands are given a second time, since a command that cannot be undone must not be repeated
  /// unnoticed.
  void warn_of_telling_again(const std::string& task) const {
    log(LogLevel::Warning, task_.user.action.empty() ? "mission" : task_.user.action,
        "task " + quote(task) +
            " has begun anew and knows nothing of what it was told; it is told once more");
  }

  /// Samples count from then on. A port of both has two readers, since one that is waited for is not read.
  Result<void> open_ports(const std::stop_token& stop) {
    for (const EndCondition& condition : use_.until) {
      const auto* shows = condition_of<SampleShows>(condition);
      if (shows == nullptr || ports_.follows(shows->port)) continue;
      auto samples = robot_.open(shows->port, until(stop));
      if (!samples) return samples.error();
      ports_.follow(shows->port, std::move(*samples));
    }
    return {};
  }

  /// Watches until a condition holds, the controller is lost, or the action is preempted.
  Ending watch(const std::stop_token& stop) {
    if (use_.until.empty()) return {0, {}};
    controller_.ask();
    while (!stop.stop_requested()) {
      if (controller_.may_have_changed()) {
        if (auto lost = loss(stop)) return *lost;
      }
      const auto met = first_that_holds(stop);
      if (!met) {
        TimePoint give_up = now() + options_.notice;
        if (auto ending = await_repair(met.error(), give_up, stop)) return *ending;
      } else if (*met < use_.until.size()) {
        return ended_by(*met, stop);
      }
      if (forget_begun_anew()) {
        if (auto ending = tell_tasks(stop)) return *ending;
      }
      tasks_.ask();
      ports_.ask();
      controller_.ask();
      bell_->wait({std::min(controller_.next_question(), next_poll()), stop});
    }
    return preempted();
  }

  [[nodiscard]] std::uint64_t updates_when_told(const std::string& task) const {
    const auto found = told_.find(task);
    return found == told_.end() ? 0 : found->second;
  }

  void follow_tasks() {
    for (const EndCondition& condition : use_.until) {
      if (const auto* reaches = condition_of<TaskReaches>(condition))
        tasks_.follow(reaches->task, updates_when_told(reaches->task));
      if (const auto* answers = condition_of<OperationAnswers>(condition))
        tasks_.follow(answers->operation.task, UINT64_MAX, kBetweenCallsWithoutUpdates);
      if (const auto* shows = condition_of<SampleShows>(condition)) tasks_.follow_if_seen(shows->port.task);
    }
    for (const auto* told : {&use_.call, &use_.write}) {
      for (const MemberValue& one : *told)
        tasks_.follow_if_seen(one.member.task);
    }
    for (const OutputSource& one : use_.outputs)
      tasks_.follow_if_seen(one.port.task);
  }

  /// Waits until the robot has repaired the loss of a task that made something fail, so that it can be tried
  /// again. The repair must have begun by `give_up`, which moves on while it goes on. The ending where the
  /// robot does not repair it, where the time is up before, and where nothing was lost.
  std::optional<Ending> await_repair(const Error& error, TimePoint& give_up, const std::stop_token& stop) {
    bool was_lost = false;
    while (!stop.stop_requested()) {
      const auto trouble = robot_.trouble(use_.controller, until(stop));
      if (!trouble) return stop.stop_requested() ? preempted() : failed(trouble.error(), stop);
      if (auto lost = loss_by(*trouble)) return lost;
      if (const auto up = time_is_up()) return ended_by(*up, stop);
      const bool mends = !trouble->repair.empty();
      const bool runs = all_tasks_run(stop) && !mends;
      was_lost = was_lost || !runs || tasks_.has_begun_anew();
      if (runs && was_lost && !tasks_.lacks_any()) return std::nullopt;
      if (mends) give_up = now() + options_.notice;
      if (now() > give_up || (!was_lost && !may_be_lost(error))) return aborted(error);
      wait(stop);
      tasks_.ask();
      (void)tasks_.poll();  // those that cannot be seen do not run
    }
    return preempted();
  }

  [[nodiscard]] bool is_up(const TimeIsUp& when) const { return now() - begin_ >= when.after; }
  [[nodiscard]] std::optional<std::size_t> time_is_up() const {
    for (std::size_t i = 0; i < use_.until.size(); ++i) {
      const auto* time = std::get_if<TimeIsUp>(&use_.until[i].when);
      if (time != nullptr && is_up(*time)) return i;
    }
    return std::nullopt;
  }

  /// Whether all tasks run. A task that does not will begin anew, without its commands; one that only does
  /// not answer may still have them.
  bool all_tasks_run(const std::stop_token& stop) {
    bool all = true;
    for (const std::string& id : tasks_.ids()) {
      const auto task = robot_.task(id, {std::min(answer_by(), end_of_time()), stop});
      if (task && task->state == "running") continue;
      if (task || may_be_lost(task.error())) tasks_.note_gone(id);
      all = false;
    }
    return all;
  }

  /// When a condition may hold although nothing has been said of a task or a port.
  [[nodiscard]] TimePoint next_poll() const {
    return std::min({tasks_.next_question(), ports_.next_question(), next_call_, end_of_time()});
  }

  /// When its own time is up; never before its tasks have been told.
  [[nodiscard]] TimePoint end_of_time() const {
    TimePoint end = TimePoint::max();
    for (const EndCondition& condition : use_.until) {
      const auto* time = std::get_if<TimeIsUp>(&condition.when);
      if (time != nullptr && begin_ != TimePoint::max()) end = std::min(end, begin_ + time->after);
    }
    return end;
  }

  /// The position of the first condition that holds; their number if none does.
  Result<std::size_t> first_that_holds(const std::stop_token& stop) {
    if (auto polled = ports_.poll(); !polled) return polled.error();
    if (auto polled = tasks_.poll(); !polled) return polled.error();
    next_call_ = TimePoint::max();
    if (tasks_.has_begun_anew()) return use_.until.size();  // these are told first
    for (std::size_t i = 0; i < use_.until.size(); ++i) {
      const auto met = std::visit([&](const auto& when) { return is_met(when, stop); }, use_.until[i].when);
      if (!met) return met.error();
      if (*met) return i;
    }
    return use_.until.size();
  }

  Ending ended_by(std::size_t condition, const std::stop_token& stop) {
    if (!ran_well_when(use_.until[condition])) {
      if (auto lost = loss(stop)) return *lost;
    }
    const Outcome outcome = task_.outcomes[condition];
    if (outcome >= 0) return {outcome, {}};
    return {outcome, sentence(use_.until[condition])};
  }

  /// Whether what has been heard of a task says that the controller ran as it should, too.
  bool ran_well_when(const EndCondition& condition) {
    const auto* reaches = condition_of<TaskReaches>(condition);
    const TaskView* task = reaches == nullptr ? nullptr : tasks_.view(reaches->task);
    return task != nullptr && controller_.ran_well_when(*task);
  }
  /// The ending where the controller does not run as it should.
  std::optional<Ending> loss(const std::stop_token& stop) {
    const auto trouble = controller_.trouble(until(stop));
    if (!trouble) return stop.stop_requested() ? preempted() : failed(trouble.error(), stop);
    return loss_by(*trouble);
  }
  [[nodiscard]] std::optional<Ending> loss_by(const ControllerTrouble& trouble) const {
    return ending_by(trouble, use_.controller,
                     [this](const std::string& task) { return awaits_failure(use_, task); });
  }

  Result<bool> is_met(const TimeIsUp& when, const std::stop_token& /*stop*/) const { return is_up(when); }
  Result<bool> is_met(const RobotCondition& when, const std::stop_token& stop) {
    return std::visit([&](const auto& one) { return is_met(one, stop); }, when);
  }
  Result<bool> is_met(const TaskReaches& when, const std::stop_token& /*stop*/) {
    const TaskView* task = tasks_.view(when.task);
    return task != nullptr && is_in(*task, when) &&
           (task->updates > updates_when_told(when.task) || task->state != "running");
  }
  Result<bool> is_met(const SampleShows& when, const std::stop_token& /*stop*/) {
    return std::ranges::any_of(ports_.fresh(when.port),
                               [&](const Value& sample) { return holds(when.what, sample); });
  }
  Result<bool> is_met(const OperationAnswers& when, const std::stop_token& stop) {
    Called& last = called_[to_string(when.operation)];
    const std::uint64_t news = tasks_.news(when.operation.task);
    if (news == last.news) return false;
    if (now() < last.again) {
      next_call_ = std::min(next_call_, last.again);
      return false;
    }
    last = {news, now() + WatchedTasks::kBetweenUpdates};
    return holds(robot_, when, {answer_by(), stop});
  }

  Result<void> read_outputs(const std::stop_token& stop, std::vector<Value>& outputs) {
    const TimePoint deadline = answer_by();
    for (std::size_t i = 0; i < use_.outputs.size(); ++i) {
      PortFeed& one = *outputs_[i];
      while (true) {
        if (auto polled = one.poll(until(stop)); !polled) return polled;
        if (one.last) break;
        if (stop.stop_requested() || now() > deadline) {
          return fail(ErrorCode::DeadlineExceeded, "no sample came from " + to_string(one.port) +
                                                       " for the output " + quote(use_.outputs[i].output));
        }
        wait(stop);
      }
      outputs[task_.output_places[i]] = *one.last;
    }
    return {};
  }

  void wait(const std::stop_token& stop) const { wait_for_next_poll(options_.period, stop); }

  /// Waits as long as the robot takes.
  static Wait until(const std::stop_token& stop) { return {TimePoint::max(), stop}; }
  [[nodiscard]] TimePoint answer_by() const { return now() + options_.answer_deadline; }

  Shared& shared_;
  CommandedRobot& robot_;
  const ControllerOptions& options_;
  Task task_;
  const ControllerUse& use_;
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  WatchedTasks tasks_{robot_, bell_};
  WatchedPorts ports_{bell_};
  WatchedController controller_{robot_, *shared_.controllers, use_.controller, bell_};
  /// When an operation was called: after which answer of its task, and from when on it may be again.
  struct Called {
    std::uint64_t news = 0;
    TimePoint again{};
  };
  std::map<std::string, Called> called_;
  TimePoint next_call_ = TimePoint::max();
  TimePoint begin_ = TimePoint::max();  ///< when its tasks had been told
  TaskCommands commands_;
  bool is_told_;
  std::map<std::string, std::uint64_t> told_;     ///< how often each task had been updated then
  std::vector<std::optional<PortFeed>> outputs_;  ///< of each of `use_.outputs`
};

}  // namespace

class ControllerRunner::Implementation {
 public:
  Implementation(std::shared_ptr<CommandedRobot> robot, const ControllerOptions& options,
                 std::shared_ptr<ControllerUnion> controllers)
      : shared_(std::move(robot), options, std::move(controllers)) {}

  std::optional<Ending> start(ActionCall& call) {
    const auto& use = std::get<ControllerUse>(call.action().run);
    auto name = call.controller(use.controller);
    if (!name) return aborted(name.error());
    ControlledRun::Task task{filled(use, call), {}, {}, ++executions_};
    task.use.controller = std::move(*name);
    task.progress = ControllerProgress::of(call.progress());
    task.user = {call.path(), call.iteration()};
    task.record = call.recorder();
    for (const EndCondition& condition : use.until)
      task.outcomes.push_back(condition.outcome.empty() ? 0
                                                        : call.outcome(condition.outcome).value_or(kAborted));
    for (const OutputSource& one : use.outputs)
      task.output_places.push_back(position(call.action().outputs, one.output).value_or(0));
    if (shared_.options.look_ahead > 0) task.ahead = upcoming_controllers(call.program(), call.state());
    threads_.start(call,
                   [this, task = std::move(task)](const std::stop_token& stop, std::vector<Value>& outputs) {
                     return ControlledRun(shared_, task).run(stop, outputs);
                   });
    return std::nullopt;
  }

  Result<void> go_on(const Action& action, const ControllerProgress& progress) {
    if (progress.stage == ControllerProgress::Stage::Begins) return {};
    if (progress.stage == ControllerProgress::Stage::Tells) {
      return fail(ErrorCode::InvalidState,
                  "the run was interrupted while its controller was being told what to do");
    }
    if (!can_be_watched(std::get<ControllerUse>(action.run)))
      return fail(ErrorCode::InvalidState, "nothing but time ends it");
    const auto trouble = shared_.robot->trouble(progress.controller, Wait(TimePoint::max()));
    if (!trouble) return trouble.error();
    if (!trouble->why.empty()) {
      return fail(ErrorCode::InvalidState,
                  "controller " + quote(progress.controller) + " does not run any more: " + trouble->why);
    }
    shared_.controllers->take_over(progress.controller, progress.properties);
    return {};
  }

 private:
  Shared shared_;
  std::atomic<std::uint64_t> executions_ = 0;  ///< numbers differ, and order nothing
  ExecutionThreads threads_;                   // destroyed first: they use the others
};

ControllerRunner::ControllerRunner(std::shared_ptr<CommandedRobot> robot, const ControllerOptions& options,
                                   std::shared_ptr<ControllerUnion> controllers)
    : implementation_(std::make_unique<Implementation>(std::move(robot), options, std::move(controllers))) {}
ControllerRunner::~ControllerRunner() = default;

Result<void> ControllerRunner::go_on(const Action& action, const Value& progress) {
  return implementation_->go_on(action, ControllerProgress::of(progress));
}

std::optional<Ending> ControllerRunner::start(ActionCall& call) {
  return call.backward() ? std::optional<Ending>(Ending{}) : implementation_->start(call);
}

}  // namespace segue::mission
