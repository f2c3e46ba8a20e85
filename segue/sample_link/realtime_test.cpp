// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_connection.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task/component.hpp>
#include <segue/task/task.hpp>
#include <segue/type/describe.hpp>
#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <memory>
#include <string>
#include <vector>

namespace segue::sample_link {
namespace {

using testing::caught;
using testing::trapped;

using namespace std::chrono_literals;
using task::Component;
using task::InputPort;
using task::OutputPort;
using task::Property;
using task::PropertyOptions;
using task::ReadStatus;
using task::Task;

constexpr int kUpdates = 240;
constexpr int kWarmUp = 60;
using Scan = std::vector<double>;

TimePoint soon() {
  return RealClock::instance().now() + 120s;
}

/// The whole thread is trapped for kUpdates updates: component, ports and executor. Before, it holds `hold`
/// samples at a time, so that every slot that a sample can arrive in has been filled once.
class Trapped : public Component {
 public:
  explicit Trapped(std::latch& done) : done_(done) {}
  std::size_t hold = 0;
  InputPort<Scan> in{*this, "in"};
  OutputPort<Scan> out{*this, "out"};
  InputPort<double> number_in{*this, "number_in"};
  OutputPort<double> number_out{*this, "number_out"};
  bool misbehave = false;

 protected:
  Result<void> on_start() override {
    out.prime(Scan(100));
    copy_.reserve(100);
    count_ = 0;
    return {};
  }
  void on_update() override {
    if (!warm_) warm_up();
    if (misbehave) spare_ = std::make_unique<int>(count_);
    work();
    if (++count_ == kUpdates && warm_) {
      trapped = false;
      done_.count_down();
    }
  }
  void on_error() override { recovered(); }

 private:
  void warm_up() {
    if (held_.size() < hold) {
      if (auto sample = in.take()) held_.push_back(std::move(sample));
    } else if (count_ >= kWarmUp && (hold == 0 || last_is_filled_)) {
      held_.clear();
      count_ = 0;
      trapped = warm_ = true;
    }
  }
  void work() {
    while (in.read(copy_) == ReadStatus::NewData) {
    }
    last_is_filled_ = last_is_filled_ || (held_.size() == hold && in.read(copy_) == ReadStatus::OldData);
    const auto sample = in.take();
    while (number_in.take()) {
    }
    number_out.write(*gain_);
    (count_ % 2 == 0 ? even_ : odd_).enter();
    log(LogLevel::Debug, "a line");
    if (count_ % 7 == 3) error(bad_, "for one update");
    copy_.assign(50, *gain_);
    out.write(copy_);
    auto loan = out.loan();
    if (!loan) return;
    loan->assign(50, *gain_);
    loan.publish();
  }

  task::State even_{*this, "EVEN"};
  task::State odd_{*this, "ODD"};
  task::ErrorState bad_{*this, "BAD"};
  Property<double> gain_{*this, "gain", 1.0, PropertyOptions{.live = true}};
  std::latch& done_;
  Scan copy_;
  std::unique_ptr<int> spare_;
  std::vector<task::Sample<Scan>> held_;
  bool last_is_filled_ = false;  ///< the slot that is left while it holds samples
  bool warm_ = false;
  int count_ = 0;
};

struct Made {
  std::unique_ptr<Task> task;
  Trapped* component = nullptr;
};

Made make(const std::string& id, const Activity& activity, std::latch& done) {
  auto component = std::make_unique<Trapped>(done);
  Made made{nullptr, component.get()};
  auto task = Task::create(id, std::move(component), &activity);
  EXPECT_TRUE(task);
  made.task = std::move(*task);
  EXPECT_TRUE(made.task->configure(soon()));
  return made;
}

/// A periodic task feeds three port-driven ones through every policy; the last feeds the first.
void run_ring(const std::string& group) {
  caught = 0;
  std::latch done(4);
  const Activity periodic{.trigger = Trigger::Periodic, .period = 200us, .thread = group};
  const Activity driven{.thread = group};
  std::vector<Made> made;
  made.push_back(make("first", periodic, done));
  for (const char* id : {"second", "third", "fourth"})
    made.push_back(make(id, driven, done));
  const std::vector<Policy> policies = {{BufferKind::Data, 1},
                                        {BufferKind::Buffer, 4},
                                        {BufferKind::CircularBuffer, 4},
                                        {BufferKind::Data, 1, Transport::Automatic, true}};
  for (std::size_t i = 0; i < made.size(); ++i) {
    auto connected = connect(made[i].component->out, made[(i + 1) % made.size()].component->in, policies[i]);
    ASSERT_TRUE(connected) << to_string(connected.error());
  }
  for (auto task = made.rbegin(); task != made.rend(); ++task)
    ASSERT_TRUE(task->task->start(soon()));
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(made[0].task->set_properties(type::Value::map({{"gain", i}}), soon()));
  }
  done.wait();
  for (Made& one : made)
    EXPECT_TRUE(one.task->stop(soon()));
}

TEST(RealTime, NothingIsAllocatedOnOwnThreads) {
  run_ring("");
  EXPECT_EQ(caught, 0);
}

TEST(RealTime, NothingIsAllocatedInAThreadGroup) {
  run_ring("ring");
  EXPECT_EQ(caught, 0);
}

class Primed : public Component {
 public:
  OutputPort<Scan> out{*this, "out"};
};

class Listener : public Component {
 public:
  InputPort<Scan> in{*this, "in"};
};

TEST(RealTime, SlotsOfConnectionsThatComeAfterPrimingAllocateNothing) {
  Primed writer;
  Listener first;
  Listener second;
  writer.out.prime(Scan(100));
  ASSERT_TRUE(connect(writer.out, first.in, {BufferKind::Buffer, 4}));
  ASSERT_TRUE(connect(writer.out, second.in, {BufferKind::Buffer, 20}));
  const Scan value(100, 1.0);
  caught = 0;
  trapped = true;
  for (int i = 0; i < 20; ++i)
    writer.out.write(value);
  trapped = false;
  EXPECT_EQ(caught, 0);
  EXPECT_EQ(second.in.drain(), 20U);
}

/// A periodic task writes to one in the other memory, which writes back: both kinds of samples, and
/// doorbells.
void run_between_memories(const Policy& policy) {
  caught = 0;
  const auto first = *SharedMemory::create();
  const auto second = *SharedMemory::create();
  ASSERT_TRUE(first->admit(*second->offer()));
  ASSERT_TRUE(second->admit(*first->offer()));
  std::latch done(2);
  Made writer = make("writer", {.trigger = Trigger::Periodic, .period = 200us}, done);
  Made reader = make("reader", {}, done);
  // One slot less than the reader's endpoint has.
  writer.component->hold = reader.component->hold = policy.size + 2;
  const auto connect_shared = [&](SharedMemory& from, task::OutputPortBase& out, SharedMemory& to,
                                  task::InputPortBase& in) {
    auto endpoint = open_input(to, describe_output(from, out), in, policy);
    ASSERT_TRUE(endpoint) << to_string(endpoint.error());
    auto attached = attach_output(from, endpoint->place, out, policy);
    ASSERT_TRUE(attached) << to_string(attached.error());
  };
  connect_shared(*first, writer.component->out, *second, reader.component->in);
  connect_shared(*first, writer.component->number_out, *second, reader.component->number_in);
  connect_shared(*second, reader.component->out, *first, writer.component->in);
  connect_shared(*second, reader.component->number_out, *first, writer.component->number_in);
  ASSERT_TRUE(reader.task->start(soon()));
  ASSERT_TRUE(writer.task->start(soon()));
  done.wait();
  EXPECT_TRUE(writer.task->stop(soon()));
  EXPECT_TRUE(reader.task->stop(soon()));
  EXPECT_GT(reader.component->number_in.samples_read(), 0U);
  EXPECT_GT(reader.component->in.samples_read(), 0U);
  EXPECT_EQ(caught, 0);
}

TEST(RealTime, NothingIsAllocatedBetweenProcesses) {
  run_between_memories({BufferKind::Data, 1});
  run_between_memories({BufferKind::Buffer, 4});
  run_between_memories({BufferKind::CircularBuffer, 4});
}

TEST(RealTime, TrapCatchesADeliberateAllocation) {
  caught = 0;
  std::latch done(1);
  Made made = make("bad", {.trigger = Trigger::Periodic, .period = 100us}, done);
  made.component->misbehave = true;
  ASSERT_TRUE(made.task->start(soon()));
  done.wait();
  ASSERT_TRUE(made.task->stop(soon()));
  EXPECT_GT(caught, kUpdates / 2);
}

}  // namespace
}  // namespace segue::sample_link
