// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/network.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// The experiments of `segue bench`: chains P -> R1 -> ... -> Rn -> C of the bench components, brought up,
/// taken down, and exchanged in part while samples run through them.
namespace segue::cli {

enum class Placement { OneProcess, ProcessEach };
std::string to_string(Placement placement);

/// The relays of a chain that are exchanged.
enum class Exchange {
  None,
  One,  ///< the one in the middle
  All,
  Block,  ///< the half in the middle: best case, because most connections are between tasks of the same kind
  EverySecond  ///< worst case: every connection changes
};

struct ChainOptions {
  std::size_t relays = 0;
  Exchange exchange = Exchange::None;
  Placement placement = Placement::OneProcess;
};
model::Network relay_chain(const ChainOptions& options);

/// The name and title of a series.
struct Experiment {
  std::string name;  ///< "E2.3 worst"; with underscores, the name of its files
  std::string title;
};
/// All series in their order: E1.1, E1.2, E2.1, E2.2, E2.3 best, E2.3 worst, E2.3 gap.
const std::vector<Experiment>& experiments();

/// One measurement.
struct Measurement {
  std::string experiment;
  Placement placement = Placement::OneProcess;
  std::size_t relays = 0;
  double seconds = 0;
};

/// A robot that executes transitions and measures them, in seconds.
class BenchRobot {
 public:
  BenchRobot() = default;
  BenchRobot(const BenchRobot&) = delete;
  BenchRobot& operator=(const BenchRobot&) = delete;
  virtual ~BenchRobot() = default;
  virtual Result<double> switch_to(const model::Network& network) = 0;
  /// Blocks until the consumer has received a sample that was sent after this call.
  virtual Result<void> wait_for_samples() = 0;
  /// Starts, and ends, the measurement of the longest gap between two samples at the consumer, in seconds.
  virtual Result<void> watch_gap() = 0;
  virtual Result<double> longest_gap() = 0;
};

/// Runs the experiments of one placement. `report` is called with every measurement and returns whether to
/// continue. The robot keeps running the last network.
Result<void> run_experiments(BenchRobot& robot, Placement placement, const std::vector<std::size_t>& sizes,
                             std::size_t repeat, const std::function<bool(const Measurement&)>& report);

}  // namespace segue::cli
