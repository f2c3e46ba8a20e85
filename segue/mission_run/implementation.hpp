// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/diagram.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/unit_keeper.hpp>
#include <segue/mission/units.hpp>
#include <segue/mission_engine/run_journal.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/task_network/completion_queue.hpp>
#include <segue/task_network/flat_file.hpp>

#include <chrono>
#include <ctime>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

/// The runs behind LoadedMission::run. Internal.
namespace segue::mission_run::detail {

using RunResult = Result<std::unique_ptr<FinishedRun>>;
using SharedProgram = std::shared_ptr<const mission::Program>;

/// Each blocks until its run has ended; the mode is that of the request.
RunResult run_as_written(SharedProgram program, const RunRequest& request, const Sequential& how,
                         const std::stop_token& stop);
RunResult run_concurrently(SharedProgram program, const RunRequest& request, const Concurrent& how,
                           const std::stop_token& stop);
RunResult run_network(std::shared_ptr<const task_network::FlatNetwork> network, const RunRequest& request,
                      const std::stop_token& stop);

/// The start of the run: as requested, or where the journal says that it continues. `runners` are those of
/// the run, which say what can go on. `journal` is set if one is wanted.
Result<mission::RunJournal::Start> open_journal(const mission::Mission& mission, const RunRequest& request,
                                                const mission::Runners& runners,
                                                std::shared_ptr<mission::RunJournal>& journal);

/// Tells the robot that keeps units of the mission, if there is one, of the run with that start; the
/// observer, maybe null, tells it of their changes.
Result<mission::UnitObserver> follow_units(const mission::Mission& mission, const RunRequest& request,
                                           const mission::RunJournal::Start& start,
                                           const mission::RunJournal* journal);

/// The diagram of a mission, planned as the request says. Blocks.
Result<draw::Diagram> diagram_of(const SharedProgram& program, const ConvertRequest& request);

/// By port of the mission; null for its default. NotFound, TypeMismatch.
Result<std::vector<type::Value>> inputs_by_port(const mission::Program& program, const type::ValueMap& given);
/// ParseError; InvalidArgument for what does not fit the mission's predicates.
Result<std::vector<mission::Fact>> parse_facts(const std::vector<std::string>& texts,
                                               const mission::Mission& mission);
/// Those of the request, with scripts and simulation as it says.
mission::Runners runners_for(const RunRequest& request);

inline task_network::ClockKind clock_kind(RunClock clock) {
  return clock == RunClock::Virtual ? task_network::ClockKind::Virtual : task_network::ClockKind::Real;
}

using Microseconds = std::chrono::duration<double, std::micro>;

inline double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Measures the processor time of this thread from its construction on.
class ProcessorTime {
 public:
  [[nodiscard]] Duration used() const { return now() - begin_; }

 private:
  static Duration now() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + Duration(time.tv_nsec);
  }
  Duration begin_ = now();
};

}  // namespace segue::mission_run::detail
