// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/mission_run/run_request.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "../command.hpp"
#include "run_files.hpp"

namespace segue::cli {

/// Options that mostly matter to concurrent runs.
struct NetworkOptions {
  std::string order = "epoch";
  std::uint64_t seed = 0;
  std::uint32_t workers = 0;
  std::uint32_t world_copies = 0;
  std::uint32_t ahead = 0;
  double least_likelihood = 0;
  bool strict = false;
  std::vector<std::string> resources;  ///< NAME=COUNT
};

struct MissionOptions {
  std::string file;
  std::string mode;  ///< "": task networks concurrently, missions sequentially
  std::string clock = "real";
  bool simulate = false;
  bool through_robot = false;  ///< others see and steer it through the robot, whatever it needs
  std::vector<std::string> inputs;
  std::vector<std::string> facts;
  std::string start_at;
  std::vector<std::string> breakpoints;
  bool steps_back = false;
  std::vector<std::string> libraries;
  std::string journal;  ///< "": none
  bool resume = false;
  std::string under_way = "go-on";
  RunFiles files;
  bool follow = false;     ///< print its events
  bool progress = true;    ///< show what goes on, in real time
  bool show = true;        ///< what was executed, on standard output
  bool until_eof = false;  ///< the end of standard input preempts it, as a signal does
  std::string asked_by;    ///< for whom it runs, for the robot's journal; empty: for nobody else
  std::string python = "python3";
  std::size_t look_ahead = 3;  ///< controllers of a robot that are kept prepared
};

/// The options for what is in NetworkOptions.
void add_network_options(Verb& verb, NetworkOptions& options);
/// --libraries
void add_library_option(Verb& verb, MissionOptions& options);

/// The inputs that --input options name: "NAME=VALUE", the value as in YAML; of two with one name the last
/// counts. InvalidArgument, ParseError.
Result<type::ValueMap> parse_inputs(const std::vector<std::string>& texts);

/// The run that these options ask for. InvalidArgument and ParseError for what is not written as it must be,
/// Unsupported for options that such a plan or mode does not have. `steering` steers a mission, and must
/// outlive its run.
Result<mission_run::RunRequest> run_request(const MissionOptions& options, const NetworkOptions& network,
                                            bool is_network, mission_run::RunControl& steering);

}  // namespace segue::cli
