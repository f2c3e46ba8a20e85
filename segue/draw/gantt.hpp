// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/report.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace segue::draw {

/// A run as drawings and traces show it, apart from what ran: a task network or anything else whose parts
/// have names, times and reasons for waiting. Times are since the run began; positions are in `nodes`.
struct Gantt {
  /// One run of a node; a node may have several.
  struct Bar {
    std::uint32_t node = 0;
    TimePoint from;
    TimePoint until;
    std::size_t lane = 0;  ///< the first that was free, as if each lane could do one thing
    bool wasted = false;   ///< thrown away
  };
  struct Node {
    std::string name;
    cdtn::NodeClass kind = cdtn::NodeClass::Irreversible;
    cdtn::NodeStatus status = cdtn::NodeStatus::NotReached;
    std::string outcome{};     ///< empty where it did not end
    bool critical = false;     ///< in the chain of nodes that the run was as long for
    bool speculative = false;  ///< its run that counts began before that was certain
    std::vector<cdtn::Wait> waits{};
    std::vector<std::uint32_t> resources{};
    std::vector<std::uint32_t> bars{};  ///< from arrange()
  };
  struct Resource {
    std::string name;
    std::vector<std::uint32_t> bars{};  ///< of those who used it, from arrange()
  };

  std::string name;
  std::string outcome;
  Duration makespan{};
  cdtn::RunSummary summary;
  cdtn::RunStatistics statistics;
  std::vector<Node> nodes;  ///< in program order
  std::vector<Bar> bars;    ///< by their start
  std::vector<Resource> resources;

  /// Sorts the bars, gives them lanes and tells nodes and resources which are theirs. Once, when all else is
  /// filled in.
  void arrange();
};

Gantt gantt_of(const cdtn::TaskNetwork& network, const cdtn::Order& order, const cdtn::RunResult& result,
               const cdtn::RunSummary& summary);

/// An SVG drawing, by node and by resource: how long nodes waited and for what, what was run ahead and what
/// for nothing, the critical chain. Times in seconds.
std::string to_svg(const Gantt& gantt);

/// One HTML file that needs nothing else: the same to zoom, move and search in, by node and by resource, with
/// the comparison with the sequential run and a table of the nodes.
std::string to_html(const Gantt& gantt);

/// The JSON of Chrome's trace viewer, which Perfetto reads: a row for each resource and each lane of nodes.
std::string to_trace(const Gantt& gantt);

}  // namespace segue::draw
