// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/task.hpp>
#include <segue/type/describe.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace demo {

/// Enough words that a torn sample cannot go unnoticed.
struct Stamped {
  std::uint32_t writer = 0;
  std::uint64_t count = 0;
  std::array<std::uint64_t, 30> check{};

  void stamp(std::uint32_t by, std::uint64_t number) {
    writer = by;
    count = number;
    check.fill(number * 31 + by);
  }
  [[nodiscard]] bool whole() const {
    for (const std::uint64_t word : check) {
      if (word != count * 31 + writer) return false;
    }
    return true;
  }
};

SEGUE_TYPE(Stamped, writer, count, check)

}  // namespace demo

namespace segue::sample_link {
namespace {

using namespace std::chrono_literals;
using demo::Stamped;
using task::Component;
using task::InputPort;
using task::OutputPort;
using task::ReadStatus;
using task::Sample;
using task::Task;

constexpr std::uint32_t kWriters = 3;
constexpr std::uint32_t kReaders = 2;

TimePoint soon() {
  return RealClock::instance().now() + 300s;
}

/// Writes as fast as it can.
class Writer : public Component {
 public:
  explicit Writer(std::uint32_t number) : number_(number) {}
  OutputPort<Stamped> out{*this, "out"};

 protected:
  void on_update() override {
    for (int i = 0; i < 8; ++i) {
      if (auto loan = out.loan()) {
        loan->stamp(number_, ++count_);
        loan.publish();
      }
    }
  }

 private:
  std::uint32_t number_;
  std::uint64_t count_ = 0;
};

/// Takes all samples and counts violations. One port per writer, so that the order of each connection can be
/// checked.
class Reader : public Component {
 public:
  Reader() {
    for (std::uint32_t i = 0; i < kWriters; ++i) {
      ports.push_back(std::make_unique<InputPort<Stamped>>(*this, "in" + std::to_string(i)));
    }
  }
  std::vector<std::unique_ptr<InputPort<Stamped>>> ports;
  std::array<std::atomic<bool>, kWriters> closed{};     ///< no sample may arrive
  std::array<std::atomic<int>, kWriters> connection{};  ///< number of the current connection
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> torn{0};
  std::atomic<std::uint64_t> out_of_order{0};
  std::atomic<std::uint64_t> ghosts{0};

 protected:
  void on_update() override {
    for (std::uint32_t i = 0; i < kWriters; ++i) {
      const int number = connection[i];
      const bool was_closed = closed[i];
      Stamped copy;
      const ReadStatus status = ports[i]->read(copy);
      if (was_closed && connection[i] == number && status != ReadStatus::NoData) ++ghosts;
      if (status != ReadStatus::NewData) continue;
      check(i, number, copy);
      while (const Sample<Stamped> sample = ports[i]->take())
        check(i, number, *sample);
    }
  }

 private:
  void check(std::uint32_t port, int number, const Stamped& sample) {
    ++received;
    if (!sample.whole() || sample.writer != port) ++torn;
    // A connection with init may begin with the last sample of an earlier one.
    const bool may_repeat = seen_[port] != number || connection[port] != number;
    if (may_repeat ? sample.count < last_[port] : sample.count <= last_[port]) ++out_of_order;
    seen_[port] = number;
    last_[port] = sample.count;
  }
  std::array<std::uint64_t, kWriters> last_{};
  std::array<int, kWriters> seen_{};
};

template <class C, class... Arguments>
std::pair<std::unique_ptr<Task>, C*> running(const std::string& id, const Activity& activity,
                                             Arguments... arguments) {
  auto component = std::make_unique<C>(arguments...);
  C* made = component.get();
  auto task = Task::create(id, std::move(component), &activity);
  EXPECT_TRUE(task);
  EXPECT_TRUE((*task)->configure(soon()));
  EXPECT_TRUE((*task)->start(soon()));
  return {std::move(*task), made};
}

Policy policy_of(unsigned number) {
  switch (number % 4) {
    case 0:
      return {BufferKind::Data, 1};
    case 1:
      return {BufferKind::Buffer, 4};
    case 2:
      return {BufferKind::CircularBuffer, 3};
    default:
      return {BufferKind::Data, 1, Transport::Automatic, true};
  }
}

/// Every thread connects and disconnects its own pairs of ports, over and over.
TEST(Storm, ConnectingAtFullRateNeitherTearsNorReordersNorHaunts) {
  const Activity activity{.trigger = Trigger::Periodic, .period = 50us};
  std::vector<std::pair<std::unique_ptr<Task>, Writer*>> writers;
  std::vector<std::pair<std::unique_ptr<Task>, Reader*>> readers;
  for (std::uint32_t i = 0; i < kReaders; ++i) {
    readers.push_back(running<Reader>("reader" + std::to_string(i), activity));
    for (auto& closed : readers.back().second->closed)
      closed = true;
  }
  for (std::uint32_t i = 0; i < kWriters; ++i) {
    writers.push_back(running<Writer>("writer" + std::to_string(i), activity, i));
  }
  const auto storm = [&](std::uint32_t reader_number) {
    std::minstd_rand random(reader_number + 1);
    Reader& reader = *readers[reader_number].second;
    for (int round = 0; round < 300; ++round) {
      const auto w = static_cast<std::uint32_t>(random() % kWriters);
      ++reader.connection[w];
      reader.closed[w] = false;
      auto made =
          connect(writers[w].second->out, *reader.ports[w], policy_of(static_cast<unsigned>(random())));
      ASSERT_TRUE(made) << to_string(made.error());
      const std::uint64_t before = reader.received;
      for (int spin = 0; spin < 20 && reader.received == before; ++spin)
        std::this_thread::yield();
      (*made)->disconnect();
      reader.closed[w] = true;
    }
  };
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < kReaders; ++i)
    threads.emplace_back(storm, i);
  for (std::thread& thread : threads)
    thread.join();
  std::uint64_t received = 0;
  for (auto& [task, reader] : readers) {
    EXPECT_TRUE(task->stop(soon()));
    EXPECT_EQ(reader->torn, 0U);
    EXPECT_EQ(reader->out_of_order, 0U);
    EXPECT_EQ(reader->ghosts, 0U);
    received += reader->received;
  }
  EXPECT_GT(received, 0U);
}

/// Counts samples, and says which it has seen.
class Counter : public Component {
 public:
  InputPort<Stamped> first{*this, "first"};
  InputPort<Stamped> second{*this, "second"};
  std::atomic<std::uint64_t> seen{0};

  void on_update() override {
    std::uint64_t newest = ~std::uint64_t{0};
    for (InputPort<Stamped>* input : {&first, &second}) {
      Stamped sample;
      static_cast<void>(input->read(sample));
      newest = std::min(newest, sample.count);
    }
    seen.store(newest);
    seen.notify_one();
  }
};

/// Tasks with a thread each, and tasks that share one: the writer wakes each thread at most once for a
/// sample.
TEST(Storm, SampleForManyReadersReachesThemAllThoughTheirThreadsFallAsleepMeanwhile) {
  class Many : public Component {
   public:
    OutputPort<Stamped> output{*this, "output"};
  } writer;
  std::vector<std::unique_ptr<Task>> tasks;
  std::vector<Counter*> counters;
  std::vector<std::shared_ptr<PortConnection>> connections;
  for (int i = 0; i < 20; ++i) {
    auto component = std::make_unique<Counter>();
    counters.push_back(component.get());
    Activity activity;
    if (i >= 10) activity.thread = "readers";
    auto made = Task::create("reader" + std::to_string(i), std::move(component), &activity);
    ASSERT_TRUE(made);
    tasks.push_back(std::move(*made));
    for (InputPort<Stamped>* input : {&counters.back()->first, &counters.back()->second}) {
      auto connected = connect(writer.output, *input, {});
      ASSERT_TRUE(connected);
      connections.push_back(std::move(*connected));
    }
    ASSERT_TRUE(tasks.back()->configure(soon()));
    ASSERT_TRUE(tasks.back()->start(soon()));
  }
  for (std::uint64_t number = 1; number <= 300; ++number) {
    Stamped sample;
    sample.stamp(0, number);
    writer.output.write(sample);
    for (Counter* counter : counters) {
      for (std::uint64_t seen = counter->seen.load(); seen < number; seen = counter->seen.load())
        counter->seen.wait(seen);
    }
  }
}

/// Ports are destroyed on one side while the other side disconnects them.
TEST(Storm, BothEndsMayGoAtOnce) {
  struct Owner : Component {};
  for (int round = 0; round < 300; ++round) {
    Owner owner;
    auto out = std::make_unique<OutputPort<int>>(owner, "out");
    auto in = std::make_unique<InputPort<int>>(owner, "in");
    auto made = connect(*out, *in, {});
    ASSERT_TRUE(made);
    out->write(round);
    std::atomic<int> ready{0};
    const auto together = [&ready] {
      ++ready;
      while (ready < 3)
        std::this_thread::yield();
    };
    std::thread first([&] {
      together();
      out.reset();
    });
    std::thread second([&] {
      together();
      in.reset();
    });
    together();
    (*made)->disconnect();
    first.join();
    second.join();
    EXPECT_FALSE((*made)->connected());
  }
}

/// Notices when a hook or update runs while another one does.
struct Careful : Component {
  InputPort<int> in{*this, "in"};
  std::atomic<int> inside{0};
  std::atomic<int> collisions{0};
  int plain = 0;  // for the thread sanitizer
  void touch() {
    if (++inside != 1) ++collisions;
    ++plain;
    --inside;
  }
  Result<void> on_start() override {
    touch();
    return {};
  }
  void on_update() override {
    touch();
    int value = 0;
    in.read(value);
  }
  void on_stop() override { touch(); }
};

/// Life-cycle verbs from several threads, while samples make the task update.
TEST(Storm, VerbsAndUpdatesExcludeEachOther) {
  auto component = std::make_unique<Careful>();
  Careful* careful = component.get();
  auto task = Task::create("careful", std::move(component));
  ASSERT_TRUE(task);
  ASSERT_TRUE((*task)->configure(soon()));
  struct Owner : Component {};
  Owner owner;
  OutputPort<int> out(owner, "out");
  ASSERT_TRUE(connect(out, careful->in, {}));
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 0; !done; ++i)
      out.write(i);
  });
  std::vector<std::thread> callers;
  for (int i = 0; i < 2; ++i) {
    callers.emplace_back([&] {
      for (int j = 0; j < 500; ++j) {
        static_cast<void>((*task)->start(soon()));
        static_cast<void>((*task)->stop(RealClock::instance().now() + 20us));
      }
    });
  }
  for (std::thread& caller : callers)
    caller.join();
  done = true;
  writer.join();
  EXPECT_EQ(careful->collisions, 0);
  EXPECT_GT(careful->plain, 0);
}

}  // namespace
}  // namespace segue::sample_link
