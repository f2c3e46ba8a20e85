// SPDX-License-Identifier: Apache-2.0
#include "parameter_client.hpp"

namespace ros2 {

using segue::type::Value;

segue::Result<std::unique_ptr<ParameterClient>> ParameterClient::make(
    const std::shared_ptr<Participant>& participant, const std::string& node) {
  segue::ros2::InterfaceLibrary library;
  auto requester = Requester::make(participant, library, node + "/set_parameters_atomically",
                                   "rcl_interfaces/srv/SetParametersAtomically");
  if (!requester) return requester.error();
  std::unique_ptr<ParameterClient> made(new ParameterClient);
  made->node_ = node;
  made->set_ = std::move(*requester);
  made->set_->allow(true);
  return made;
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
