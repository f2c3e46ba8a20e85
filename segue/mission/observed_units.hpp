// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/robot_condition.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace segue::mission {

/// So many units as a field of the latest sample of a port says, a number, which is rounded down.
struct SampleCounts {
  model::Member port;
  std::vector<std::string> field;  ///< its parts (model::parse_field); empty: the sample itself
  friend bool operator==(const SampleCounts&, const SampleCounts&) = default;
};

/// How a robot shows the units of a resource: all of them while a condition holds, and none otherwise; or
/// how many there are.
using ObservedUnits = std::variant<model::RobotCondition, SampleCounts>;

/// A number of shown units that stands for all of a resource.
inline constexpr std::uint32_t kAllUnits = std::numeric_limits<std::uint32_t>::max();

/// The number of units that a sample says; none where it has no such number.
std::uint32_t units_in(const SampleCounts& counts, const type::Value& sample);

/// The task that is observed.
const std::string& task_of(const ObservedUnits& observed);

/// The reason why an execution that needs so many units waits, while the robot shows fewer: "waits for 1 unit
/// of the resource 'localized', which the robot does not show: task 'localization' is not LOCALIZED".
std::string unshown_text(std::string_view resource, const ObservedUnits& observed, std::uint32_t needed,
                         std::uint32_t shown);

}  // namespace segue::mission
