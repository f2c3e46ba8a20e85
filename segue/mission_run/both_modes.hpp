// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission_run/run_request.hpp>

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <variant>

/// For tests of what holds in either mode.
namespace segue::mission_run {

inline const std::array<RunMode, 2> kBothModes = {Sequential{}, Concurrent{}};

inline bool is_concurrent(const RunMode& mode) {
  return std::holds_alternative<Concurrent>(mode);
}

/// For INSTANTIATE_TEST_SUITE_P.
inline std::string name_of_mode(const ::testing::TestParamInfo<RunMode>& mode) {
  return is_concurrent(mode.param) ? "Concurrent" : "Sequential";
}

}  // namespace segue::mission_run
