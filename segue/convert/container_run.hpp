// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/track.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace segue::convert {

/// One execution of a container in the plan, for followers of the run: no node stands for it. It has ended
/// once all its planned nodes are over and one of its exits is taken for certain, or with the container
/// around it.
struct ContainerRun {
  std::shared_ptr<ContainerRun> around;  ///< null: the mission itself
  mission::StateIndex state = mission::kNoState;
  std::string path;
  std::uint32_t iteration = 0;  ///< how many executions of the state are planned before it
  BranchEdge when;
  std::uint32_t open = 0;     ///< nodes in it, at any depth, that are planned and not over
  std::vector<Exit> exits{};  ///< as far as they are planned
  bool lost = false;          ///< a state that raced with it has ended first: it takes none of its exits
  bool told = false;          ///< its begin was reported
};

}  // namespace segue::convert
