// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/has_answered.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/mission_robot/pool_runner.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/execution_threads.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/pool_call.hpp>
#include <segue/mission_robot/robot_poll.hpp>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

namespace segue::mission {

using type::Value;

namespace {

/// How long a question for an instance waits before it is asked again.
constexpr Duration kPatience = std::chrono::minutes(10);

/// The instances of the robot's pools, for several executions at once. Thread safe.
class Instances {
 public:
  Instances(std::shared_ptr<CommandedRobot> robot, const PoolOptions& options)
      : robot_(std::move(robot)), options_(options) {}

  Result<PoolView> query(const std::string& pool, const std::stop_token& stop) const {
    const auto pools = robot_->pools(Wait(TimePoint::max(), stop));
    if (!pools) return pools.error();
    const auto found = std::ranges::find(*pools, pool, &PoolView::name);
    if (found != pools->end()) return *found;
    return fail(ErrorCode::NotFound, "the robot has no pool " + quote(pool));
  }

  /// Blocks until the robot gives an instance; rather another one than `lost`, whose task may run again.
  /// Cancelled when asked to stop.
  Result<model::TakenInstance> take(const std::string& pool, const model::TakenInstance& lost,
                                    const std::stop_token& stop) const {
    while (true) {
      auto taken =
          answer_to<model::TakenInstance>(Wait(RealClock::instance().now() + kPatience, stop),
                                          [&](const Wait& wait, model::InstanceAnswer answer) {
                                            robot_->take_instance({pool, lost}, wait, std::move(answer));
                                          });
      if (taken || taken.error().code != ErrorCode::DeadlineExceeded) return taken;
    }
  }

  /// Whether that is why it did not answer. The robot may need a moment to notice.
  bool is_lost(const std::string& pool, const model::TakenInstance& instance, const Error& error,
               const std::stop_token& stop) const {
    const bool has_answered =
        error.code == ErrorCode::DeadlineExceeded || error.code == ErrorCode::HookFailed;
    if (has_answered || stop.stop_requested()) return false;
    const TimePoint give_up = RealClock::instance().now() + options_.notice;
    while (true) {
      const auto view = query(pool, stop);
      if (!view) return false;
      const auto now = std::ranges::find(view->instances, instance.task, &PoolInstanceView::task);
      if (now == view->instances.end() || !now->ready || now->pid != instance.pid) return true;
      if (error.code != ErrorCode::Unavailable || RealClock::instance().now() > give_up) return false;
      wait_for_next_poll(options_.period, stop);
      if (stop.stop_requested()) return false;
    }
  }

  /// Where the robot cannot be reached, tells whoever is to stop the run, and blocks until it is stopped.
  bool stops_since_robot_is_gone(const Error& why, const std::stop_token& stop) const {
    if (!options_.unreachable || robot_->pools(Wait(TimePoint::max(), stop))) return false;
    if (!stop.stop_requested()) options_.unreachable(why);
    while (!stop.stop_requested())
      wait_for_next_poll(options_.period, stop);
    return true;
  }

 private:
  const std::shared_ptr<CommandedRobot> robot_;
  const PoolOptions options_;
};

/// A call of an instance in a thread of its own, since it may outlast the action that made it.
class InstanceCall {
 public:
  struct Outcome {
    Result<Value> answer;
    bool lost = false;  ///< the instance was
  };
  struct Job {
    std::string pool;
    model::TakenInstance instance;
    std::string operation;
    Value arguments;
    Duration timeout{};
  };

  /// Std::system_error where there can be no thread.
  static std::shared_ptr<InstanceCall> begin(std::shared_ptr<CommandedRobot> robot,
                                             const Instances& instances, ExecutionThreads& threads, Job job) {
    auto call = std::make_shared<InstanceCall>();
    threads.start(
        {}, [call, robot = std::move(robot), &instances, job = std::move(job)](const std::stop_token& stop) {
          const Wait wait(RealClock::instance().now() + job.timeout, stop);
          auto answer = robot->call({job.instance.task, job.operation}, job.arguments, wait);
          const bool lost = !answer && instances.is_lost(job.pool, job.instance, answer.error(), stop);
          call->set({std::move(answer), lost});
        });
    return call;
  }

  /// Nothing where a stop is requested before it has answered.
  std::optional<Outcome> wait(const std::stop_token& stop) {
    Lock lock(mutex_);
    answered_.wait(mutex_, stop, [this]() SEGUE_REQUIRES(mutex_) { return outcome_.has_value(); });
    return outcome_;
  }

 private:
  void set(Outcome outcome) {
    const Lock lock(mutex_);
    outcome_ = std::move(outcome);
    answered_.notify_all();
  }

  Mutex mutex_;  ///< protects the outcome
  StoppableConditionVariable answered_;
  std::optional<Outcome> outcome_;
};

/// A pool on demand may have none at the moment.
std::size_t most_instances(const PoolView& pool) {
  return std::max<std::size_t>(pool.most, pool.instances.size());
}

/// One execution of an action.
class PoolExecution {
 public:
  explicit PoolExecution(const ActionCall& call)
      : call_(std::get<PoolCall>(call.action().run)),
        arguments_(call.filled(call_.arguments)),
        outcomes_(call.action().outcomes),
        may_repeat_(call.action().pure) {
    for (const ResultField& one : call_.outputs)
      output_places_.push_back(position(call.action().outputs, one.output).value_or(0));
  }

  /// Blocks until the action has ended. One that is preempted does not wait for its instance.
  Ending run(const std::shared_ptr<CommandedRobot>& robot, const Instances& instances,
             ExecutionThreads& threads, const std::stop_token& stop, std::vector<Value>& outputs) const {
    model::TakenInstance lost;
    for (std::size_t attempt = 1;; ++attempt) {
      const auto instance = instances.take(call_.pool, lost, stop);
      if (!instance) return failed(instance.error(), instances, stop);
      const auto outcome = ask(robot, instances, threads, *instance, stop);
      if (!outcome || stop.stop_requested()) return {kPreempted, {}};
      if (outcome->answer) return ended_with(*outcome->answer, outputs);
      if (!outcome->lost) return failed(explained(outcome->answer.error(), *instance), instances, stop);
      lost = *instance;
      const auto pool = instances.query(call_.pool, stop);
      // An instance that is not in a state for it, such as one that is being stopped, has not begun.
      const bool may_repeat = may_repeat_ || outcome->answer.error().code == ErrorCode::InvalidState;
      if (!pool || !may_repeat || attempt > most_instances(*pool))
        return failed(
            fail(ErrorCode::Unavailable, lost_text(*instance, attempt)).because_of(outcome->answer.error()),
            instances, stop);
    }
  }

 private:
  [[nodiscard]] std::optional<InstanceCall::Outcome> ask(const std::shared_ptr<CommandedRobot>& robot,
                                                         const Instances& instances,
                                                         ExecutionThreads& threads,
                                                         const model::TakenInstance& instance,
                                                         const std::stop_token& stop) const {
    try {
      return InstanceCall::begin(robot, instances, threads,
                                 {call_.pool, instance, call_.operation, arguments_, call_.timeout})
          ->wait(stop);
    } catch (const std::system_error& failed) {
      return InstanceCall::Outcome{
          fail(ErrorCode::ResourceExhausted, std::string("no thread: ") + failed.what())};
    }
  }

  /// The ending with this error; without its robot, the run ends as one that can be resumed.
  static Ending failed(const Error& error, const Instances& instances, const std::stop_token& stop) {
    const bool is_preempted = stop.stop_requested() || instances.stops_since_robot_is_gone(error, stop);
    return is_preempted ? Ending{kPreempted, {}} : Ending{kAborted, to_string(error)};
  }

  /// Names the limit where it was too short.
  [[nodiscard]] Error explained(const Error& error, const model::TakenInstance& instance) const {
    if (error.code != ErrorCode::DeadlineExceeded) return error;
    return fail(error.code, instance.task + "." + call_.operation +
                                " has not answered within the action's 'timeout' of " +
                                format_duration(call_.timeout))
        .because_of(error);
  }

  [[nodiscard]] std::string lost_text(const model::TakenInstance& instance, std::size_t attempts) const {
    return instance.task + " was lost while it worked" +
           (attempts == 1 ? std::string()
                          : ", as were others before: " + std::to_string(attempts) + " attempts have failed");
  }

  Ending ended_with(const Value& answer, std::vector<Value>& outputs) const {
    for (std::size_t i = 0; i < call_.outputs.size(); ++i) {
      const Value* part = field_of(answer, call_.outputs[i].field);
      if (part == nullptr) return without(call_.outputs[i].field);
      outputs[output_places_[i]] = *part;
    }
    if (call_.outcome_from.empty()) return {0, {}};
    const Value* outcome = field_of(answer, call_.outcome_from);
    if (outcome == nullptr || !outcome->is_string()) return without(call_.outcome_from);
    const auto found = std::ranges::find(outcomes_, outcome->as_string());
    if (found != outcomes_.end()) return {static_cast<Outcome>(found - outcomes_.begin()), {}};
    return {kAborted, call_.pool + "." + call_.operation + " answered " + quote(outcome->as_string()) +
                          " as " + quote(call_.outcome_from) +
                          (outcome->as_string() == kAbortedName ? "" : ", which is none of its outcomes")};
  }

  [[nodiscard]] Ending without(const std::string& field) const {
    return {kAborted, "the answer of " + call_.pool + "." + call_.operation + " has no field " +
                          quote(field) + (field == call_.outcome_from ? " with a text" : "")};
  }

  const PoolCall call_;
  const Value arguments_;
  const std::vector<std::string> outcomes_;
  const bool may_repeat_;
  std::vector<std::size_t> output_places_;
};

}  // namespace

class PoolRunner::Implementation {
 public:
  Implementation(std::shared_ptr<CommandedRobot> robot, const PoolOptions& options)
      : robot_(std::move(robot)), instances_(robot_, options) {}

  void start(ActionCall& call) {
    threads_.start(call, [this, execution = PoolExecution(call)](const std::stop_token& stop,
                                                                 std::vector<Value>& outputs) {
      return execution.run(robot_, instances_, threads_, stop, outputs);
    });
  }

 private:
  const std::shared_ptr<CommandedRobot> robot_;
  const Instances instances_;
  ExecutionThreads threads_;  // destroyed first: they use the others
};

PoolRunner::PoolRunner(std::shared_ptr<CommandedRobot> robot, const PoolOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(robot), options)) {}
PoolRunner::~PoolRunner() = default;

std::optional<Ending> PoolRunner::start(ActionCall& call) {
  if (call.backward()) return Ending{};
  implementation_->start(call);
  return std::nullopt;
}

}  // namespace segue::mission
