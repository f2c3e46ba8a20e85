// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/sample_link/shared_connection.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task/component.hpp>
#include <segue/task/task.hpp>
#include <segue/type/describe.hpp>

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

namespace segue::sample_link::shared_test {

/// Enough words that a torn sample cannot go unnoticed.
struct Pose {
  Pose() = default;
  explicit Pose(std::int64_t value) : number(value) { check.fill(value * 31 + 7); }
  std::int64_t number = 0;
  std::array<std::int64_t, 30> check{};
  [[nodiscard]] bool whole() const { return *this == Pose(number) || (number == 0 && check[0] == 0); }
  friend bool operator==(const Pose&, const Pose&) = default;
};

/// 100 MB; only the pages that are written take memory.
struct Image {
  Image() {}  // NOLINT(modernize-use-equals-default): that would zero it
  std::array<std::uint8_t, 100'000'000> pixels;
};

SEGUE_TYPE(Pose, number, check)
SEGUE_TYPE(Image, pixels)

using task::Component;
using task::InputPort;
using task::OutputPort;
using task::ReadStatus;
using task::Sample;
using task::Task;
using task::WriteResult;
using testing::eventually;

inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

template <class T>
struct Source : Component {
  OutputPort<T> out{*this, "out"};
};

/// Ports without a task are told apart by their names only.
template <class T>
struct Sink : Component {
  explicit Sink(const std::string& name = "in") : in(*this, name) {}
  InputPort<T> in;
};

/// Takes all samples, one per update.
struct Counter : Component {
  InputPort<Pose> in{*this, "in"};
  std::atomic<std::int64_t> last{0};
  std::atomic<std::uint64_t> updates{0};
  std::atomic<std::uint64_t> torn{0};

 protected:
  void on_update() override {
    ++updates;
    const Sample<Pose> sample = in.take();
    if (!sample) return;
    if (!sample->whole()) ++torn;
    last = sample->number;
  }
};

template <class C>
std::pair<std::unique_ptr<Task>, C*> running(const std::string& id, const Activity& activity) {
  auto component = std::make_unique<C>();
  C* made = component.get();
  auto task = Task::create(id, std::move(component), &activity);
  EXPECT_TRUE(task);
  EXPECT_TRUE((*task)->configure(soon()));
  EXPECT_TRUE((*task)->start(soon()));
  return {std::move(*task), made};
}

struct Link {
  bool ok = false;
  Error error;
  InputPlace place;
  std::shared_ptr<SharedEndpoint> input;
  std::shared_ptr<SharedEndpoint> output;
};

constexpr SharedMemoryOptions kSmall{std::size_t{1} << 16, std::size_t{1} << 24, std::size_t{1} << 24};

/// The memories of a writing and a reading process, both of this one.
struct Pair {
  explicit Pair(const SharedMemoryOptions& options = kSmall)
      : writer(*SharedMemory::create(options)), reader(*SharedMemory::create(options)) {
    EXPECT_TRUE(writer->admit(*reader->offer()));
    EXPECT_TRUE(reader->admit(*writer->offer()));
  }

  Link connect(task::OutputPortBase& from, task::InputPortBase& to, const Policy& policy) const {
    Link link;
    auto input = open_input(*reader, describe_output(*writer, from), to, policy);
    if (!input) {
      link.error = input.error();
      return link;
    }
    link.input = input->endpoint;
    link.place = input->place;
    auto output = attach_output(*writer, input->place, from, policy);
    if (!output) {
      link.error = output.error();
      return link;
    }
    link.output = *output;
    link.ok = true;
    return link;
  }

  /// In the order that processes use: the writer first.
  void disconnect(const Link& link) const {
    link.output->disconnect();
    link.input->disconnect();
    release_input(*reader, link.place);
  }

  std::shared_ptr<SharedMemory> writer;
  std::shared_ptr<SharedMemory> reader;
};

}  // namespace segue::sample_link::shared_test
