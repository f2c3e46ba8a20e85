// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/robot_port.hpp>

#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/base/wait.hpp>
#include <segue/task_host/task_host.hpp>

#include <future>
#include <vector>

namespace segue::runtime {

Result<model::PortRef> member_of(std::string_view address) {
  const auto dot = address.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == address.size()) {
    return fail(ErrorCode::InvalidArgument, quote(address) + " is not a valid address; it is TASK.MEMBER");
  }
  return model::PortRef{model::TaskId(address.substr(0, dot)), std::string(address.substr(dot + 1))};
}

PortValues::PortValues(task_host::TaskHost& host, std::string_view address)
    : host_(&host), port_(member_of(address)) {
  static_cast<void>(connect());
}

PortValues::~PortValues() = default;
PortValues::PortValues(PortValues&& other) noexcept = default;
PortValues& PortValues::operator=(PortValues&& other) noexcept = default;

Result<void> PortValues::connect() {
  if (!port_) {
    return port_.error();
  }
  if (reader_ != nullptr) {
    return {};
  }
  auto opened = host_->open_reader(*port_, 1);
  if (!opened) {
    return std::move(opened.error());
  }
  reader_ = std::move(*opened);
  return {};
}

Result<type::Value> PortValues::next(Duration timeout) {
  if (auto connected = connect(); !connected) {
    return std::move(connected.error());
  }
  using Samples = Result<std::vector<type::Value>>;
  const auto promise = std::make_shared<std::promise<Samples>>();
  auto answer = promise->get_future();
  reader_->next(1, RealClock::instance().now() + timeout,
                [promise](Samples samples) { promise->set_value(std::move(samples)); });
  Samples samples = answer.get();
  if (!samples) {
    reader_.reset();
    return std::move(samples.error());
  }
  if (samples->empty()) {
    return fail(ErrorCode::DeadlineExceeded,
                "no sample came within " + format_seconds(timeout) + "; is the task running?",
                to_string(*port_));
  }
  last_ = std::move(samples->back());
  return *last_;
}

Result<type::Value> PortValues::latest() {
  if (auto connected = connect(); !connected) {
    return std::move(connected.error());
  }
  for (auto& sample : reader_->read(1)) {
    last_ = std::move(sample);
  }
  if (!last_) {
    return fail(ErrorCode::NotFound, "no sample has come yet", to_string(*port_));
  }
  return *last_;
}

}  // namespace segue::runtime
