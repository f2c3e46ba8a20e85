// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace segue::ros2 {

/// Parameters of a node, a map of names and values, as the request of
/// rcl_interfaces/srv/SetParametersAtomically. Maps within it are names with dots: {controller: {gain: 0.5}}
/// is "controller.gain". Whole numbers are integers, all other numbers doubles, as in ROS 2's own files.
/// `path` begins the message of an error: InvalidArgument where a value is none that a parameter can have
/// (null, lists of lists or of different kinds).
Result<type::Value> parameters_request(const type::Value& parameters, std::string_view path);

/// The same parameters of `node` ("/robot/talker") as the text of a parameter file, which ROS 2's programs
/// take with
/// --params-file. `parameters` must be one that parameters_request() takes.
std::string parameter_file(std::string_view node, const type::Value& parameters);

/// A value as rcl_interfaces/msg/ParameterValue; nothing where no parameter can have it (null, maps, lists of
/// lists or of different kinds, numbers above those of int64).
std::optional<type::Value> parameter_value(const type::Value& value);

/// A parameter from its rcl_interfaces/msg/ParameterValue, which may be of a later version: null where it is
/// not set or of no known kind.
type::Value parameter_from(const type::Value& message);
/// The name of a rcl_interfaces/msg/ParameterType as ROS 2 shows it: "integer", "double array"; "not set".
std::string_view parameter_kind(std::int64_t number);

}  // namespace segue::ros2
