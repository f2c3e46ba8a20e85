// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/ids.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

/// Bringing a robot to rest (model::Halt).
namespace segue::runtime {

/// Who wants the robot to rest, and why.
struct HaltRequest {
  std::string who;
  std::string why{};   ///< "mission 'fetch' was lost"; may be empty
  bool latch = false;  ///< until release(), whatever is requested is refused
};

/// How a robot came to rest, or did not.
struct HaltResult {
  bool at_rest = false;
  Duration duration{0};  ///< from the request
  std::vector<model::TaskId>
      stopped;          ///< tasks with devices, stopped since the robot was not at rest in time
  std::string trouble;  ///< why it was not; empty: it was
};

/// A robot that is halted, or is on its way.
struct Halted {
  HaltRequest request;
  std::chrono::system_clock::time_point time;
  std::optional<HaltResult> result;  ///< nothing: it is on its way
  std::string stopped_by{};          ///< who keeps it so until release(); empty: nobody
};

}  // namespace segue::runtime
