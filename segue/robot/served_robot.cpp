// SPDX-License-Identifier: Apache-2.0
#include <segue/robot/served_robot.hpp>

#include <segue/base/text.hpp>

#include <utility>

namespace segue::robot {

using type::Value;

namespace {

/// Samples that a reader may be behind; older ones are dropped.
constexpr std::size_t kBuffer = 64;

std::string text_at(const Value& value, std::string_view key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_string() ? std::string() : found->as_string();
}

std::string name_of(std::string_view controller) {
  return controller.empty() ? "the empty network" : "controller " + quote(controller);
}

class StreamSamples final : public mission::PortSamples {
 public:
  explicit StreamSamples(std::unique_ptr<control::SampleStream> stream) : stream_(std::move(stream)) {}
  Result<std::vector<Value>> take() override { return stream_->read(kBuffer); }

 private:
  const std::unique_ptr<control::SampleStream> stream_;
};

}  // namespace

Result<void> ServedRobot::request(std::string_view controller, TimePoint deadline) {
  control::SwitchOptions options;
  options.who = who_;
  const auto answer = service_.switch_to(controller, options, deadline);
  if (!answer) return answer.error();
  const std::string outcome = text_at(*answer, "outcome");
  if (outcome == "done") return {};
  const std::string error = text_at(*answer, "error");
  const ErrorCode code = outcome == "superseded" ? ErrorCode::Superseded : ErrorCode::InvalidState;
  return fail(code, "the request for " + name_of(controller) + " was " + outcome +
                        (error.empty() ? std::string() : ": " + error));
}

Result<std::string> ServedRobot::trouble(std::string_view controller) {
  const auto status = service_.status();
  if (!status) return status.error();
  const std::string running = text_at(*status, "controller");
  if (running != controller) return "the robot runs " + name_of(running);
  const Value* unresolved = status->find("unresolved");
  if (unresolved == nullptr || !unresolved->is_list() || unresolved->as_list().empty()) return std::string();
  const Value& first = unresolved->as_list().front();
  return first.is_string() ? first.as_string() : std::string("it has failed");
}

Result<void> ServedRobot::set(const mission::Member& property, const Value& value, TimePoint deadline) {
  return service_.set_property(property.task, property.name, value, deadline);
}

Result<Value> ServedRobot::call(const mission::Member& operation, const Value& arguments,
                                TimePoint deadline) {
  return service_.call(operation.task, operation.name, arguments, deadline);
}

Result<mission::TaskView> ServedRobot::task(std::string_view id) {
  const auto report = service_.task(id);
  if (!report) return report.error();
  const Value* cycles = report->find("cycles");
  return mission::TaskView{text_at(*report, "state"), text_at(*report, "state_name"),
                           cycles != nullptr && cycles->is_integer() ? cycles->as_uint() : 0};
}

Result<std::unique_ptr<mission::PortSamples>> ServedRobot::open(const mission::Member& port) {
  auto stream = service_.open_port(port.task, port.name, kBuffer);
  if (!stream) return stream.error();
  return std::make_unique<StreamSamples>(std::move(*stream));
}

}  // namespace segue::robot
