// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>

#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "run_files.hpp"

namespace segue::cli {

struct MissionOptions {
  std::string file;
  std::string mode = "sequential";
  std::string clock = "real";
  bool simulate = false;
  std::vector<std::string> inputs;
  std::vector<std::string> facts;
  std::string start_at;
  std::vector<std::string> libraries;
  std::string journal;  ///< "": none
  bool resume = false;
  std::string under_way = "refuse";
  RunFiles files;
  bool show = true;  ///< what was executed, on standard output
  std::string python = "python3";
};

/// --libraries
void add_library_option(Verb& verb, MissionOptions& options);

/// What executes its actions: Python, and simulation where that is asked for.
mission::Runners runners_of(const MissionOptions& options);
/// "NAME=VALUE", the value as in YAML. InvalidArgument, ParseError.
Result<std::pair<std::string, type::Value>> parse_input(const std::string& text);

/// What --fact says. ParseError.
Result<std::vector<mission::Fact>> given_facts(const std::vector<std::string>& texts);

/// Runs the mission and shows what was executed. SIGINT and SIGTERM preempt it.
int run_mission(const MissionOptions& options, const Context& context);

}  // namespace segue::cli
