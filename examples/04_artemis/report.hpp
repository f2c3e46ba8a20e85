// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/embedded_robot.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// The output of the Artemis demo.
namespace demo {

/// Counters of all running tasks so far.
struct Flow {
  std::uint64_t samples = 0;                    ///< read from all connections
  std::map<std::string, std::uint64_t> missed;  ///< per task: periods without an update
  std::map<std::string, std::uint64_t> cycles;  ///< per task: updates since its start
};
Flow measure_flow(segue::runtime::EmbeddedRobot& robot);

class Report {
 public:
  /// Reads the paper's table. `everything`: print every action. `in_process`: there are no other processes.
  /// `hosts`: where they are; none: on the runtime's own.
  static segue::Result<Report> create(const std::filesystem::path& table, bool everything, bool in_process,
                                      std::vector<std::string> hosts);

  void introduce(segue::runtime::EmbeddedRobot& robot);
  bool started(const segue::runtime::SwitchResult& result);
  /// False if the transition failed.
  bool switched(const segue::runtime::SwitchResult& result, const Flow& before, const Flow& after);
  void flowed(const Flow& flow);
  void ended(const segue::runtime::SwitchResult& result);
  /// Compares the running system with the controller: processes and shared memory as the operating system
  /// reports them, tasks and connections as the processes report them.
  void check_processes(segue::runtime::EmbeddedRobot& robot);
  /// False if a count differs from the paper's, if a task was disturbed that no transition concerned, or if
  /// anything was left over or missing.
  bool summarise();

 private:
  using Columns = std::vector<std::pair<std::string, int>>;

  void print_actions(const segue::runtime::SwitchResult& result) const;
  void print_counts(const segue::model::ActionCounts& counts, const Columns& paper);
  /// The number of running tasks that the transition did not concern.
  int note_undisturbed(const segue::runtime::SwitchResult& result, const Flow& before, const Flow& after);

  bool everything_ = false;
  bool in_process_ = false;
  std::vector<std::string> hosts_;
  std::map<std::pair<std::string, std::string>, Columns> table_;
  int transitions_ = 0;
  int actions_ = 0;
  int numbers_equal_ = 0;
  int numbers_ = 0;
  int undisturbed_ = 0;
  int disturbed_ = 0;
  int looks_ = 0;
  int wrong_looks_ = 0;
  std::size_t fewest_ = 0;
  std::size_t most_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t samples_before_ = 0;
  segue::Duration longest_{0};
  segue::Duration switching_{0};
};

}  // namespace demo
