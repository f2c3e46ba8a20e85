// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

namespace segue::cli {

/// Lets other programs see and steer a mission that commands a robot, through that robot: `segue mission
/// status`, `pause`, `step` and so on, and the studio; and the robot record it in its journal.
class MissionRemote {
 public:
  enum class PlanDetail { States, Whole };
  /// The plan of the mission (draw::shown_plan): its states are reported at the beginning, so that a mission
  /// that has ended can still be shown; the whole plan, which takes longer to make, when somebody wants to
  /// see it.
  using Plan = std::function<type::Value(PlanDetail)>;

  /// `mode`: how the run goes, for the journal (remote_robot::MissionRecord::began).
  /// Starts a thread that reports and listens until this is destroyed. All must outlive it. `stop` is
  /// requested when the mission shall stop; where it is requested otherwise, the robot hears it at once.
  MissionRemote(remote_robot::ServedRobot& robot, const mission::Program& program, Plan plan,
                std::string_view mode, mission_run::RunControl& control, std::stop_source stop);
  MissionRemote(const MissionRemote&) = delete;
  MissionRemote& operator=(const MissionRemote&) = delete;

  /// Takes an event of the run. Any thread may call it.
  void observe(const mission::StateEvent& event);
  /// The run has ended, `error` says why it aborted. Its actions are in the robot's journal once this is
  /// destroyed, as far as the robot could be reached.
  void ended(std::string_view outcome, std::string_view error);

 private:
  /// The answers to the requests that the mission got.
  class Answers {
   public:
    void heard(std::uint64_t number, const Result<void>& outcome);
    void heard_values(std::uint64_t number, const std::string& path, const Result<type::Value>& values);
    /// Rung when something is new.
    [[nodiscard]] Bell& bell() { return bell_; }
    void add_to(type::ValueMap& control) const;

   private:
    void note(std::uint64_t number, const std::optional<Error>& refused) SEGUE_REQUIRES(mutex_);

    Bell bell_;
    mutable Mutex mutex_;  ///< protects all below
    std::uint64_t heard_ SEGUE_GUARDED_BY(mutex_) = 0;
    type::Value problem_ SEGUE_GUARDED_BY(mutex_);
    type::Value values_ SEGUE_GUARDED_BY(mutex_);
  };

  void work(const std::stop_token& end);
  void heed(const control::HolderRequest& request);
  void report(type::Value& reported);
  [[nodiscard]] type::Value doing() const;
  [[nodiscard]] type::Value steering() const;

  remote_robot::ServedRobot& robot_;
  const std::string mission_;
  const bool keeps_;          ///< the robot runs on, however the mission ends
  const bool halts_at_stop_;  ///< the mission has nothing to do when it is stopped
  const Plan plan_;
  mission_run::RunControl& control_;
  std::stop_source stop_;
  const std::shared_ptr<Answers> answers_ = std::make_shared<Answers>();      ///< shared with who answers
  mutable Mutex mutex_;                                                       ///< protects the next two
  std::multiset<std::string, std::less<>> running_ SEGUE_GUARDED_BY(mutex_);  ///< paths of actions
  std::uint64_t ended_ SEGUE_GUARDED_BY(mutex_) = 0;                          ///< actions
  std::optional<PlanDetail> to_show_ = PlanDetail::States;                    ///< for the thread only
  struct Stopping {
    Answers& answers;
    void operator()() const { answers.bell().ring(); }
  };
  std::jthread thread_;  ///< runs from the end of the construction on
  const std::stop_callback<Stopping> stopping_;
};

}  // namespace segue::cli
