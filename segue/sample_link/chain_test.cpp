// SPDX-License-Identifier: Apache-2.0
// Tasks that are connected to each other wake each other.
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/task.hpp>

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace std::chrono_literals;
using task::Component;
using task::InputPort;
using task::OutputPort;
using task::ReadStatus;
using task::WriteResult;
using ::testing::ElementsAre;

std::shared_ptr<PortConnection> join(task::OutputPortBase& from, task::InputPortBase& to,
                                     const Policy& policy = {}) {
  auto made = connect(from, to, policy);
  EXPECT_TRUE(made) << to_string(made.error());
  return made ? *made : nullptr;
}

std::vector<int> all_from(InputPort<int>& port) {
  std::vector<int> values;
  int value = 0;
  while (port.read(value) == ReadStatus::NewData)
    values.push_back(value);
  return values;
}

/// Tasks connected to each other.
class Relay : public Component {
 public:
  InputPort<int> in{*this, "in"};
  OutputPort<int> out{*this, "out"};
  int updates = 0;
  bool reads = true;

 protected:
  void on_update() override {
    ++updates;
    if (!reads) return;
    int value = 0;
    if (in.read(value) == ReadStatus::NewData) out.write(value + 1);
  }
};

class Chain : public ::testing::Test {
 protected:
  static TimePoint soon() { return RealClock::instance().now() + 60s; }
  Relay& add(const std::string& id) {
    auto component = std::make_unique<Relay>();
    Relay& relay = *component;
    auto made = task::Task::create(id, std::move(component), Activity{}, executor);
    EXPECT_TRUE(made);
    EXPECT_TRUE((*made)->configure(soon()));
    tasks.push_back(std::move(*made));
    return relay;
  }
  VirtualClock clock;
  std::shared_ptr<task::ManualExecutor> executor = std::make_shared<task::ManualExecutor>(clock);
  std::vector<std::unique_ptr<task::Task>> tasks;
};

TEST_F(Chain, SampleRunsThroughAllTasks) {
  Relay& first = add("first");
  Relay& second = add("second");
  Relay& third = add("third");
  join(first.out, second.in);
  join(second.out, third.in);
  for (const auto& task : tasks)
    ASSERT_TRUE(task->start(soon()));
  Relay source;
  join(source.out, first.in);
  InputPort<int> sink(source, "sink");
  join(third.out, sink);
  source.out.write(0);
  EXPECT_EQ(executor->run_ready(), 3U);
  EXPECT_EQ(*sink.take(), 3);
}

TEST_F(Chain, OneWakeUpForManySamplesServesThemAll) {
  Relay& relay = add("relay");
  ASSERT_TRUE(tasks[0]->start(soon()));
  Relay source;
  join(source.out, relay.in, {BufferKind::Buffer, 10});
  for (int i = 0; i < 10; ++i)
    source.out.write(i);
  executor->run_ready();
  EXPECT_EQ(relay.updates, 10);
}

TEST_F(Chain, FullBufferStillWakesAReaderThatDidNotReadBefore) {
  Relay& relay = add("relay");
  Relay source;
  join(source.out, relay.in, {BufferKind::Buffer, 1});
  ASSERT_TRUE(tasks[0]->start(soon()));
  relay.reads = false;
  source.out.write(1);
  EXPECT_EQ(executor->run_ready(), 1U) << "without progress it does not spin";
  relay.reads = true;
  EXPECT_EQ(source.out.write(2), WriteResult::Refused);
  executor->run_ready();
  EXPECT_EQ(relay.updates, 2);
  EXPECT_EQ(source.out.write(3), WriteResult::Written);
}

TEST_F(Chain, SampleFromBeforeTheStartIsServedAtTheStart) {
  Relay& relay = add("relay");
  Relay source;
  join(source.out, relay.in);
  source.out.write(1);
  executor->run_ready();
  EXPECT_EQ(relay.updates, 0);
  ASSERT_TRUE(tasks[0]->start(soon()));
  executor->run_ready();
  EXPECT_EQ(relay.updates, 1);
}

TEST_F(Chain, LastValueOfAnEarlierWriterTriggersANewReader) {
  Relay& relay = add("relay");
  ASSERT_TRUE(tasks[0]->start(soon()));
  Relay source;
  source.out.write(1);
  join(source.out, relay.in, {.kind = BufferKind::Data, .init = true});
  executor->run_ready();
  EXPECT_EQ(relay.updates, 1);
}

TEST_F(Chain, StatePortTellsEveryChange) {
  add("watched");
  Relay watcher;
  InputPort<std::int32_t> states(watcher, "states");
  join(*tasks[0]->component().find_output("state"), states, {BufferKind::Buffer, 10});
  ASSERT_TRUE(tasks[0]->start(soon()));
  ASSERT_TRUE(tasks[0]->stop(soon()));
  ASSERT_TRUE(tasks[0]->cleanup(soon()));
  EXPECT_THAT(all_from(states), ElementsAre(2, 1, 0));
}

TEST_F(Chain, DestroyedTaskTakesItsConnectionsAlong) {
  Relay& relay = add("relay");
  ASSERT_TRUE(tasks[0]->start(soon()));
  Relay source;
  const auto connection = join(source.out, relay.in);
  tasks.clear();
  EXPECT_FALSE(connection->connected());
  EXPECT_EQ(source.out.write(1), WriteResult::NotConnected);
}

}  // namespace
}  // namespace segue::sample_link
