// SPDX-License-Identifier: Apache-2.0
#include <segue/host/port_reader.hpp>

#include <segue/base/text.hpp>
#include <segue/link/local.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <mutex>

namespace segue::host::detail {

namespace {

/// A connection reserves its samples beforehand.
constexpr std::size_t kLargestBuffer = 100'000;

/// Owns an input port, as only components can.
class Probe final : public task::Component {
 public:
  explicit Probe(const task::OutputPortBase& port) : input(*this, "probe", port.type(), port.type_name()) {}
  task::InputPortBase input;
};

class TapReader final : public PortReader {
 public:
  explicit TapReader(const task::OutputPortBase& port) : probe_(port), type_name_(port.type_name()) {}

  task::InputPortBase& input() { return probe_.input; }

  std::vector<type::Value> read(std::size_t limit) override {
    const std::lock_guard lock(mutex_);
    std::vector<type::Value> samples;
    type::Value value;
    while (samples.size() < limit && probe_.input.read_value(value) == task::ReadStatus::NewData) {
      samples.push_back(std::move(value));
      value = {};
    }
    return samples;
  }

  [[nodiscard]] std::string type_name() const override { return type_name_; }

 private:
  std::mutex mutex_;  ///< a port has one reader at a time
  Probe probe_;
  std::string type_name_;
};

}  // namespace

Result<std::unique_ptr<PortReader>> tap(task::OutputPortBase& port, std::size_t buffer) {
  if (buffer == 0 || buffer > kLargestBuffer) {
    return fail(ErrorCode::InvalidArgument,
                "a reader's buffer holds 1 to " + std::to_string(kLargestBuffer) + " samples, not " +
                    std::to_string(buffer),
                port.full_name());
  }
  auto reader = std::make_unique<TapReader>(port);
  const Policy policy{BufferKind::CircularBuffer, buffer, Transport::Automatic, false};
  if (auto connected = link::connect(port, reader->input(), policy); !connected) {
    return std::move(connected.error());
  }
  return std::unique_ptr<PortReader>(std::move(reader));
}

}  // namespace segue::host::detail
