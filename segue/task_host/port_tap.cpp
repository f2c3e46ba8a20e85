// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/task_host/port_tap.hpp>

#include <segue/base/text.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>

#include <atomic>
#include <string>
#include <utility>

namespace segue::task_host::detail {

namespace {

/// A connection reserves its samples beforehand.
constexpr std::size_t kLargestBuffer = 100'000;

/// Owns an input port, as only components can.
class Probe final : public task::Component {
 public:
  explicit Probe(const task::OutputPortBase& port) : input(*this, "probe", port.type(), port.type_name()) {}
  task::InputPortBase input;
};

/// The state that a reader shares with whoever waits for its samples.
class Tap {
 public:
  Tap(const task::OutputPortBase& port, std::weak_ptr<task::Task> task)
      : task_(std::move(task)), probe_(port), full_name_(port.full_name()) {}

  task::InputPortBase& input() { return probe_.input; }

  std::vector<type::Value> read(std::size_t limit) {
    const Lock lock(mutex_);
    std::vector<type::Value> samples;
    type::Value value;
    while (samples.size() < limit && probe_.input.read_value(value) == task::ReadStatus::NewData) {
      samples.push_back(std::move(value));
      value = {};
    }
    return samples;
  }

  /// Reads samples, and has the watches rung after the task's next update.
  Result<std::vector<type::Value>> read_and_announce(std::size_t limit) {
    if (is_closed_.load()) return no_longer_wanted();
    const auto task = task_.lock();
    if (task) task->announce_next_update();  // before the samples are read
    auto samples = read(limit);
    if (samples.empty() && !task) return fail(ErrorCode::NotFound, "its task is gone", full_name_);
    return samples;
  }

  void close() { is_closed_ = true; }

 private:
  const std::weak_ptr<task::Task> task_;
  Mutex mutex_;  ///< a port has one reader at a time
  Probe probe_;
  const std::string full_name_;
  std::atomic<bool> is_closed_ = false;  ///< set before the ring (W1) after which it is looked at
};

class TapReader final : public PortReader {
 public:
  TapReader(const task::OutputPortBase& port, std::shared_ptr<Watches> watches,
            std::weak_ptr<task::Task> task)
      : tap_(std::make_shared<Tap>(port, std::move(task))),
        watches_(std::move(watches)),
        type_name_(port.type_name()) {}
  ~TapReader() override {
    tap_->close();
    watches_->ring();
  }
  TapReader(const TapReader&) = delete;
  TapReader& operator=(const TapReader&) = delete;

  task::InputPortBase& input() { return tap_->input(); }

  std::vector<type::Value> read(std::size_t limit) override { return tap_->read(limit); }

  void next(std::size_t limit, const Wait& wait, SamplesAnswer answered) override {
    using End = Watches::End;
    watches_->add(wait, [tap = tap_, limit, answered = std::move(answered)](End end) {
      if (end == End::Stop || end == End::Closed) {
        answered(end == End::Stop ? no_longer_wanted() : fail(ErrorCode::Unavailable, "its host ends"));
        return true;
      }
      auto samples = tap->read_and_announce(limit);
      if (samples && samples->empty() && end == End::No) return false;
      answered(std::move(samples));
      return true;
    });
  }

  [[nodiscard]] std::string type_name() const override { return type_name_; }

 private:
  const std::shared_ptr<Tap> tap_;
  const std::shared_ptr<Watches> watches_;
  const std::string type_name_;
};

}  // namespace

Result<std::unique_ptr<PortReader>> tap(task::OutputPortBase& port, std::size_t buffer,
                                        std::shared_ptr<Watches> watches, std::weak_ptr<task::Task> task) {
  if (buffer == 0 || buffer > kLargestBuffer) {
    return fail(ErrorCode::InvalidArgument,
                "a reader's buffer holds 1 to " + std::to_string(kLargestBuffer) + " samples, not " +
                    std::to_string(buffer),
                port.full_name());
  }
  auto reader = std::make_unique<TapReader>(port, std::move(watches), std::move(task));
  const Policy policy{BufferKind::CircularBuffer, buffer, Transport::Automatic, false};
  if (auto connected = sample_link::connect(port, reader->input(), policy); !connected) {
    return std::move(connected.error());
  }
  return std::unique_ptr<PortReader>(std::move(reader));
}

}  // namespace segue::task_host::detail
