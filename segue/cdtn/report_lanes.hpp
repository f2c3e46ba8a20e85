// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/network.hpp>
#include <segue/cdtn/run_result.hpp>

#include <vector>

namespace segue::cdtn::detail {

/// One run of a node in a drawing.
struct Bar {
  NodeId node{};
  TimePoint from;
  TimePoint until;
  std::size_t lane = 0;
  bool wasted = false;
};

/// All runs, each in the first lane that is free.
std::vector<Bar> lanes_of(const Network& network, const RunResult& result);
/// The runs that used a resource.
std::vector<Bar> uses_of(const Network& network, const RunResult& result, ResourceId resource);

}  // namespace segue::cdtn::detail
