// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/halt.hpp>
#include <segue/model/network.hpp>
#include <segue/model/reader.hpp>
#include <segue/model/robot.hpp>

#include <optional>
#include <vector>

namespace segue::model::detail {

/// "halt" of a robot file.
std::optional<Halt> read_halt(Fields& robot, const Source& source);
/// Checks that its controller exists, and that its conditions name tasks of the robot.
void check_halt(const Robot& robot, const std::vector<Network>& networks, Diagnostics& diagnostics);

}  // namespace segue::model::detail
