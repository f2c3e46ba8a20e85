// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "measure.hpp"

#include <segue/base/policy.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/executor_set.hpp>
#include <segue/task/task.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Chains of tasks without files or a runtime, to measure ports, links and executors alone.
namespace bench {

struct Stamped {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
};

struct Blob {
  std::int64_t sent_ns = 0;
  std::vector<std::uint8_t> data;
};

SEGUE_TYPE(Stamped, sent_ns, number)
SEGUE_TYPE(Blob, sent_ns, data)

inline std::int64_t now_ns() {
  return segue::RealClock::instance().now().time_since_epoch().count();
}

/// Written by the benchmark's own thread.
template <class T>
class Source : public segue::task::Component {
 public:
  segue::task::OutputPort<T> output{*this, "output"};
};

class Relay : public segue::task::Component {
 public:
  segue::task::InputPort<Stamped> input{*this, "input"};
  segue::task::OutputPort<Stamped> output{*this, "output"};
  bool notes_time = false;
  std::atomic<std::int64_t> updated_ns{0};  ///< when the last update began, if it notes that

  void on_update() override {
    if (notes_time) updated_ns.store(now_ns(), std::memory_order_relaxed);
    Stamped sample;
    while (input.read(sample) == segue::task::ReadStatus::NewData)
      output.write(sample);
  }
};

/// Records the arrival of samples.
template <class T>
class Sink : public segue::task::Component {
 public:
  segue::task::InputPort<T> input{*this, "input"};
  std::atomic<std::uint64_t> arrived{0};
  std::atomic<std::int64_t> last_ns{0};       ///< time of arrival
  std::atomic<std::int64_t> last_sent_ns{0};  ///< time of sending, from the sample

  void on_update() override {
    while (auto sample = input.take()) {
      last_sent_ns.store(sample->sent_ns, std::memory_order_relaxed);
      last_ns.store(now_ns(), std::memory_order_relaxed);
      arrived.fetch_add(1, std::memory_order_release);
    }
  }
};

/// Ends the program with the error.
void require(const segue::Result<void>& result);

/// Running tasks and their components.
class Bench {
 public:
  /// Creates, configures and starts a task.
  template <class C>
  C& run(const std::string& id, const segue::Activity& activity = {}) {
    auto component = std::make_unique<C>();
    C& made = *component;
    add(id, std::move(component), activity);
    return made;
  }
  void connect(segue::task::OutputPortBase& from, segue::task::InputPortBase& to,
               const segue::Policy& policy = {});

 private:
  void add(const std::string& id, std::unique_ptr<segue::task::Component> component,
           const segue::Activity& activity);
  segue::task::ExecutorSet executors_;
  std::vector<std::unique_ptr<segue::task::Task>> tasks_;
};

}  // namespace bench
