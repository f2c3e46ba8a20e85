// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scratch.hpp"

#include <segue/runtime/embedded_robot.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

/// Robots for benchmarks; any failure ends the program.
namespace bench {

inline segue::runtime::EmbeddedRobot open(const std::filesystem::path& file,
                                          const segue::runtime::EmbeddedOptions& options) {
  auto robot = segue::runtime::EmbeddedRobot::open(file, options);
  if (!robot) {
    std::fprintf(stderr, "%s\n", to_string(diagnostics_of(robot.error())).c_str());
    std::exit(1);
  }
  return std::move(*robot);
}

/// Ends the program where it was not done.
inline void done(const segue::runtime::SwitchResult& result) {
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.why().c_str());
    std::exit(1);
  }
}

}  // namespace bench
