// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/halt.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/condition_watch.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/halt_result.hpp>
#include <segue/runtime/runtime.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::runtime::detail {

/// A network in place of a controller that brings the robot to rest.
struct DevicesStopped {
  model::Network network;
  std::vector<model::TaskId> tasks;  ///< that are stopped
};

/// Brings the robot to rest where somebody asks for it, or a condition of its halt holds, and knows until
/// when it is to stay there. Has a thread of its own. Thread safe; nothing but the destructor blocks.
class Halts {
 public:
  /// Functions by which it asks the runtime for something, called without its own lock.
  struct Ways {
    /// Takes the robot from whoever commands it; `by` says who does.
    std::function<void(const std::string& by)> take_robot;
    /// Has the robot run that before all else.
    std::function<std::future<SwitchResult>(const std::string& by, Request request, Duration action_deadline)>
        request;
    /// The tasks that run, but for those that hold devices.
    std::function<DevicesStopped()> devices_stopped;
  };

  /// `host` and `log` must outlive this.
  Halts(task_host::TaskHost& host, EventLog& log, Ways ways);
  /// Waits for the halt on its way, which what it asks of the runtime must not outlive.
  ~Halts() { end(); }
  Halts(const Halts&) = delete;
  Halts& operator=(const Halts&) = delete;
  /// Nothing is watched and nothing is begun any more. Blocks as the destructor does.
  void end();

  /// Says how the robot rests from now on; null: the robot does not say it.
  void use(std::shared_ptr<const model::Halt> halt);
  /// The tasks of the running controller are these from now on: conditions of `when` look at no others, and
  /// anew at those that were not among them. Does not block.
  void look_at(const std::set<model::TaskId>& tasks);
  /// As long as a transition changes their states, conditions of `when` do not look at these. Does not block.
  void look_away_from(const std::set<model::TaskId>& tasks);
  /// Brings the robot to rest, whoever commands it; the result comes once it rests, or tasks that hold
  /// devices are stopped. Requests are refused from before `first` is called, which is before the runtime is
  /// asked for anything; without it, the robot is taken from whoever commands it.
  std::shared_future<HaltResult> begin(HaltRequest request, const std::function<void()>& first = {});
  [[nodiscard]] std::shared_future<HaltResult> on_its_way() const;
  /// That one, or the last, if the robot has not been commanded since.
  [[nodiscard]] std::shared_future<HaltResult> latest() const;
  Result<void> release(const std::string& who);
  [[nodiscard]] std::optional<Halted> halted() const;
  /// The robot has been commanded since it was halted.
  void forget();
  /// Why the robot cannot be commanded now.
  [[nodiscard]] std::optional<Error> refusal() const;

 private:
  /// How often each task of the running controller has come to be one, counted by `looks_`.
  using Watched = std::map<model::TaskId, std::uint64_t>;
  struct WhenWatch {
    std::uint64_t look = 0;  ///< as of Watched, for its task
    std::unique_ptr<ConditionWatch> watch;
  };
  struct UnderWay {
    Halted halted;
    TimePoint begin{};
    std::shared_ptr<const model::Halt> how{};  ///< null: its devices are stopped
    std::future<SwitchResult> switched{};      ///< not valid until the runtime has been asked
    std::vector<model::TaskId> stopped{};      ///< tasks with devices that the transition stops
    std::promise<HaltResult> promise{};
    std::shared_future<HaltResult> result{};
  };

  void work(const std::stop_token& stop);
  /// Those of `halt` whose tasks are watched, in its order; keeps what goes on of `watches`, which are of the
  /// same halt. May wait for a look in progress, so without the mutex.
  std::vector<WhenWatch> watch_when(const model::Halt& halt, const Watched& tasks,
                                    std::vector<WhenWatch> watches);
  /// Notes what holds the robot; true where that is new.
  bool note_conditions(const std::vector<WhenWatch>& watches) SEGUE_REQUIRES(mutex_);
  /// Empty: none holds.
  [[nodiscard]] std::string sentence_of_first(const std::vector<WhenWatch>& watches) const
      SEGUE_REQUIRES(mutex_);
  std::unique_ptr<ConditionWatch> watch(const model::RobotCondition& condition, ConditionWatch::From from);
  /// Not locked while it waits.
  void bring_to_rest(const std::stop_token& stop) SEGUE_REQUIRES(mutex_);
  /// In place of the controller of the halt, which has come to `trouble`.
  void stop_devices(std::string& trouble, HaltResult& result);
  /// Which conditions of rest do not hold by then.
  std::optional<std::string> wait_for_rest(const model::Halt& halt, TimePoint deadline,
                                           const std::stop_token& stop);

  task_host::TaskHost& host_;
  EventLog& log_;
  const Ways ways_;
  mutable Mutex mutex_;  ///< protects all up to changed_; not held while the runtime or the host is asked
  std::shared_ptr<const model::Halt> halt_ SEGUE_GUARDED_BY(mutex_);
  Watched watched_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t looks_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::optional<UnderWay> under_way_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Halted> last_ SEGUE_GUARDED_BY(mutex_);        ///< until the robot is commanded
  std::optional<HaltRequest> latch_ SEGUE_GUARDED_BY(mutex_);  ///< until release()
  std::string held_by_ SEGUE_GUARDED_BY(mutex_);  ///< the condition that holds, as a sentence; empty: none
  bool ended_ SEGUE_GUARDED_BY(mutex_) = false;
  mutable StoppableConditionVariable changed_;
  std::stop_source stop_;
  std::thread thread_;
};

}  // namespace segue::runtime::detail
