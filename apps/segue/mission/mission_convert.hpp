// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "mission_request.hpp"

namespace segue::cli {

struct ConvertOptions {
  MissionOptions mission;
  std::string order = "epoch";
  std::size_t horizon = 1000;
  bool strict = false;
  bool assume_expected = false;
  bool dot = false;
  bool svg = false;
  std::string output;
};

/// Shows a mission or task network as it will run concurrently, before any run.
int convert_plan(const ConvertOptions& options, const Context& context);

}  // namespace segue::cli
