// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/written_samples.hpp>

#include <segue/base/text.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>

#include <thread>
#include <utility>

namespace segue::task_host::detail {

namespace {

/// How often it is looked whether a task has taken a sample.
constexpr Duration kPollPeriod = std::chrono::milliseconds(1);

/// Owns an output port, as only components can.
class Source final : public task::Component {
 public:
  explicit Source(const task::InputPortBase& port)
      : output(*this, "written", port.type(), port.type_name()) {}
  task::OutputPortBase output;
};

}  // namespace

/// Its end removes the connection.
class WrittenSamples::Written {
 public:
  explicit Written(const task::InputPortBase& port) : source_(port) {}
  ~Written() {
    if (connection_) connection_->disconnect();
  }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  Result<std::shared_ptr<sample_link::PortConnection>> write(task::InputPortBase& port,
                                                             const type::Value& value) {
    auto connection =
        sample_link::connect(source_.output, port, {BufferKind::Buffer, 1, Transport::Automatic, false});
    if (!connection) return connection;
    connection_ = *connection;
    const auto written = source_.output.write_value(value);
    if (!written) return written.error();
    return connection_;
  }

 private:
  Source source_;
  std::shared_ptr<sample_link::PortConnection> connection_;
};

WrittenSamples::WrittenSamples() = default;
WrittenSamples::~WrittenSamples() = default;

Result<std::shared_ptr<sample_link::PortConnection>> WrittenSamples::write(task::InputPortBase& port,
                                                                           const model::PortRef& name,
                                                                           const type::Value& value) {
  if (port.type() == nullptr) {
    return fail(ErrorCode::Unsupported,
                "the type of port " + quote(name.port) + " is not known here, so no sample can be made",
                name.task.str());
  }
  auto written = std::make_unique<Written>(port);
  auto connection = written->write(port, value);
  if (!connection) return connection;
  const Lock lock(mutex_);
  on_their_way_.emplace(connection->get(), std::move(written));
  return connection;
}

Result<void> WrittenSamples::wait_until_taken(const model::PortRef& name,
                                              const sample_link::PortConnection& connection,
                                              TimePoint deadline) {
  bool taken = connection.counters().read > 0;
  while (!taken && connection.connected() && RealClock::instance().now() < deadline) {
    std::this_thread::sleep_for(kPollPeriod);
    taken = connection.counters().read > 0;
  }
  std::unique_ptr<Written> withdrawn;  // or the one before; disconnected without the mutex
  const Lock lock(mutex_);
  auto entry = on_their_way_.extract(&connection);
  if (entry.empty()) return fail(ErrorCode::Internal, "the sample is not on its way", name.task.str());
  withdrawn = std::move(entry.mapped());
  if (taken) {
    std::swap(withdrawn, taken_[name]);
    return {};
  }
  if (!connection.connected())
    return fail(ErrorCode::InvalidState, "port " + quote(name.port) + " is gone", name.task.str());
  return fail(ErrorCode::DeadlineExceeded,
              "the task has not read the sample from its port " + quote(name.port) + " in time",
              name.task.str());
}

void WrittenSamples::forget(const std::function<bool(const model::TaskId&)>& runs) {
  const Lock lock(mutex_);
  std::erase_if(taken_, [&](const auto& entry) { return !runs(entry.first.task); });
}

}  // namespace segue::task_host::detail
