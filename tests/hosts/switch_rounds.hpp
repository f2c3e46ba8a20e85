// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "troubled_robot.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Rounds of a robot on several hosts, each a request with trouble, and what must be true after each.
namespace segue::distributed::testing {

struct Round {
  int controller = 0;  ///< which one is requested
  bool paper = false;  ///< order of the transition
  std::vector<Trouble> troubles;
  int cut = -1;          ///< this host is lost before the request
  bool restart = false;  ///< the runtime is another one than in the round before
  bool heal = false;     ///< afterwards all is well again, and one request must lead to what it says
};

struct Scenario {
  int hosts = 2;
  unsigned optional = 0;       ///< a bit for each host
  std::uint64_t networks = 0;  ///< seed of the controllers
  std::vector<Round> rounds;
};

/// How often each end was seen, so that a test sees whether it tests anything.
struct Ends {
  std::map<std::string, int> counts;
  void note(const std::string& what) { ++counts[what]; }
  [[nodiscard]] int operator[](const std::string& what) const {
    const auto found = counts.find(what);
    return found == counts.end() ? 0 : found->second;
  }
};

inline constexpr int kControllers = 4;

/// Controllers on these hosts and on the runtime's own computer; related, so that tasks stay, change and
/// move.
std::vector<model::Network> random_controllers(std::uint64_t seed, int hosts);

/// Runs a scenario. Gives what was wrong first, and where; empty where all was well.
std::string run(const Scenario& scenario, Planted planted, Ends& ends);

}  // namespace segue::distributed::testing
