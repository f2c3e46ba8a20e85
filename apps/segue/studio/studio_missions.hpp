// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>
#include <segue/web/mission_starts.hpp>

#include <sys/types.h>

#include <cstddef>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace segue::cli {

/// `segue mission run` in a process of its own, which ends in order once this is asked to end, and however
/// this process ends. All functions may be called from any thread.
class MissionProcess {
 public:
  static Result<std::unique_ptr<MissionProcess>> start(std::vector<std::string> words);
  /// Ends it, and waits for that; kills it after some minutes.
  ~MissionProcess();
  MissionProcess(const MissionProcess&) = delete;
  MissionProcess& operator=(const MissionProcess&) = delete;

  /// Asks it to end: the mission is preempted, and the robot comes to rest or runs on, as it declares.
  void ask_to_end();
  [[nodiscard]] bool has_ended() const;

  /// Waits until it has printed its first line, or has ended. False at the deadline.
  bool wait_for_line(TimePoint deadline) const;
  /// Waits until it has ended. False at the deadline.
  bool wait_for_end(TimePoint deadline) const;
  /// Its output so far, up to a limit; none after forget_output().
  [[nodiscard]] std::string output() const;
  /// Nothing that it prints is kept from now on.
  void forget_output();

 private:
  MissionProcess(pid_t pid, Descriptor input, Descriptor output);
  void listen(const std::stop_token& stop);

  const pid_t pid_;
  const Descriptor output_end_;
  mutable Mutex mutex_;  ///< protects all below
  mutable ConditionVariable changed_;
  Descriptor input_ SEGUE_GUARDED_BY(mutex_);  ///< ends the mission when it closes
  std::string output_ SEGUE_GUARDED_BY(mutex_);
  bool keeps_output_ SEGUE_GUARDED_BY(mutex_) = true;
  bool ended_ SEGUE_GUARDED_BY(mutex_) = false;
  std::jthread listener_;
};

/// The missions that the pages of a studio start. All functions may be called from any thread.
class StudioMissions {
 public:
  explicit StudioMissions(std::string robot) : robot_(std::move(robot)) {}

  /// As of web::RunMission.
  Result<type::Value> run(const web::MissionOrder& order, TimePoint deadline);
  /// Ends all that run and waits until they have ended; none begins afterwards.
  void end();
  /// How many run.
  [[nodiscard]] std::size_t running() const;

 private:
  Result<std::shared_ptr<MissionProcess>> start(const web::MissionOrder& order);

  const std::string robot_;
  mutable Mutex mutex_;  ///< protects all below
  bool closed_ SEGUE_GUARDED_BY(mutex_) = false;
  std::list<std::shared_ptr<MissionProcess>> processes_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::cli
