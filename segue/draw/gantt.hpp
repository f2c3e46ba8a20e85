// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/run_report.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace segue::draw {

/// A run as charts and traces show it, independent of whether a task network or a state machine ran. Times
/// are relative to the start of the run; node numbers are positions in `nodes`. A plain value; one thread at
/// a time.
struct Gantt {
  /// One run of a node; a node may have several.
  struct Bar {
    std::uint32_t node = 0;
    TimePoint from;
    TimePoint until;
    std::size_t lane = 0;  ///< the first free one; the bars of a lane do not overlap
    bool wasted = false;   ///< the result was discarded
  };
  /// A node of the run; a row of the chart.
  struct Node {
    std::string name;
    ActionClass kind = ActionClass::Irreversible;
    task_network::NodeStatus status = task_network::NodeStatus::NotReached;
    std::string outcome{};     ///< empty if it did not end
    bool critical = false;     ///< on the chain of nodes that determined the makespan
    bool speculative = false;  ///< the run that counts began before it was certain to count
    std::vector<task_network::Wait> waits{};
    std::vector<std::uint32_t> resources{};
    std::vector<std::uint32_t> bars{};  ///< from arrange()
  };
  /// A resource with the nodes that used it.
  struct Resource {
    std::string name;
    std::vector<std::uint32_t> bars{};  ///< of the nodes that used it, from arrange()
  };

  std::string name;
  std::string outcome;
  Duration makespan{};
  task_network::RunSummary summary;
  task_network::RunStatistics statistics;
  std::vector<Node> nodes;  ///< in program order
  std::vector<Bar> bars;    ///< by their start
  std::vector<Resource> resources;

  /// Sorts the bars and assigns them to lanes, nodes and resources. Call it once, when all else is filled in.
  void arrange();
};

/// The chart of a network's run, of which `waits` is, with the nodes that are `listed`, in program order.
Gantt gantt_of(const task_network::TaskNetwork& network, const task_network::RunResult& result,
               const task_network::WaitFinder& waits, std::span<const task_network::NodeId> listed,
               const task_network::RunSummary& summary);

/// An SVG drawing by node and by resource, with waits, speculative and discarded runs, and the critical
/// chain. Times are in seconds.
std::string to_svg(const Gantt& gantt);

/// A self-contained HTML file with the same chart to zoom, move and search in, a comparison with the
/// sequential time, and a table of the nodes.
std::string to_html(const Gantt& gantt);

/// JSON in the Trace Event Format (Perfetto, Chrome), with a row for each resource and each lane of nodes.
std::string to_trace(const Gantt& gantt);

}  // namespace segue::draw
