// SPDX-License-Identifier: Apache-2.0
#include "parameter_client.hpp"

#include <cstddef>
#include <tuple>
#include <utility>

namespace ros2 {

using segue::type::Value;

segue::Result<std::unique_ptr<ParameterClient>> ParameterClient::make(
    const std::shared_ptr<Participant>& participant, const std::string& node) {
  segue::ros2::InterfaceLibrary library;
  std::unique_ptr<ParameterClient> made(new ParameterClient);
  made->node_ = node;
  for (auto& [requester, name, interface] :
       {std::tuple(&made->set_, "/set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically"),
        std::tuple(&made->get_, "/get_parameters", "rcl_interfaces/srv/GetParameters")}) {
    auto opened = Requester::make(participant, library, node + name, interface);
    if (!opened) return opened.error();
    *requester = std::move(*opened);
    (*requester)->allow(true);
  }
  return made;
}

segue::Result<std::vector<Value>> ParameterClient::get(const std::vector<std::string>& names,
                                                       segue::TimePoint deadline) {
  if (names.empty()) return std::vector<Value>();
  auto response =
      get_->call(Value::map({{"names", Value(Value::List(names.begin(), names.end()))}}), deadline);
  if (!response) return response.error();
  const auto& values = response->find("values")->as_list();
  if (values.size() == names.size()) return std::vector<Value>(values.begin(), values.end());
  // rclcpp tells nothing at all where one of them is not declared.
  std::vector<Value> told(names.size());
  for (std::size_t i = 0; names.size() > 1 && i < names.size(); ++i) {
    auto one = get({names[i]}, deadline);
    if (!one) return one.error();
    told[i] = std::move(one->front());
  }
  return told;
}

segue::Result<void> ParameterClient::set(const Value& request, segue::TimePoint deadline) {
  auto response = set_->call(request, deadline);
  if (!response) return response.error();
  const Value& result = *response->find("result");
  if (result.find("successful")->as_bool()) return {};
  const std::string& reason = result.find("reason")->as_string();
  return segue::fail(segue::ErrorCode::InvalidArgument, "node " + node_ + " refuses its parameters" +
                                                            (reason.empty() ? std::string() : ": " + reason));
}

}  // namespace ros2
