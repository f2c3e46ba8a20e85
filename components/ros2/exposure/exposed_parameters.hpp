// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The properties of a task as parameters of a node: what the services for parameters answer.
namespace ros2 {

/// A property, or a member of one.
struct ExposedParameter {
  std::string name;          ///< "gains.p"
  segue::type::Value value;  ///< as rcl_interfaces/msg/ParameterValue
  std::string doc{};
  std::string constraints{};  ///< of durations, which are numbers: "in milliseconds"
  bool is_live = false;
};

/// Those of a task (RobotService::task()). What no parameter can be is left out: null, lists of maps or of
/// lists, unsigned numbers above those of int64.
std::vector<ExposedParameter> parameters_of(const segue::type::Value& task);
const ExposedParameter* find_parameter(const std::vector<ExposedParameter>& all, std::string_view name);

/// The responses to rcl_interfaces/srv/ListParameters and so on. Names that there are not have values that
/// are not set, in their place.
segue::type::Value list_parameters(const std::vector<ExposedParameter>& all,
                                   const segue::type::Value& request);
segue::type::Value get_parameters(const std::vector<ExposedParameter>& all,
                                  const segue::type::Value& request);
segue::type::Value get_parameter_types(const std::vector<ExposedParameter>& all,
                                       const segue::type::Value& request);
/// `writable`: whether clients may set any.
segue::type::Value describe_parameters(const std::vector<ExposedParameter>& all,
                                       const segue::type::Value& request, bool writable);

/// The difference, as rcl_interfaces/msg/ParameterEvent without time and node; nothing: there is none.
std::optional<segue::type::Value> parameter_event(const std::vector<ExposedParameter>& before,
                                                  const std::vector<ExposedParameter>& now);

}  // namespace ros2
