// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task/task.hpp>
#include <segue/type/describe.hpp>

#include <support/waiting_call.hpp>

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <latch>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace demo {

struct Pose {
  double x = 0;
  double y = 0;
};

struct Image {
  std::vector<std::uint8_t> pixels;
};

SEGUE_TYPE(Pose, x, y)
SEGUE_TYPE(Image, pixels)

}  // namespace demo

namespace segue::sample_link {
namespace {

using namespace std::chrono_literals;
using task::Component;
using task::InputPort;
using task::InputPortBase;
using task::OutputPort;
using task::OutputPortBase;
using task::ReadStatus;
using task::Sample;
using task::WriteResult;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Policy kData{};
constexpr Policy buffer(std::size_t size) {
  return {BufferKind::Buffer, size};
}
constexpr Policy circular(std::size_t size) {
  return {BufferKind::CircularBuffer, size};
}

std::shared_ptr<PortConnection> connected(OutputPortBase& from, InputPortBase& to,
                                          const Policy& policy = kData) {
  auto made = connect(from, to, policy);
  EXPECT_TRUE(made) << to_string(made.error());
  return made ? *made : nullptr;
}

template <class T>
std::vector<T> read_all(InputPort<T>& port) {
  std::vector<T> values;
  T value{};
  while (port.read(value) == ReadStatus::NewData)
    values.push_back(value);
  return values;
}

class Local : public ::testing::Test {
 protected:
  struct Owner : Component {};
  Owner writer;
  Owner reader;
};

TEST_F(Local, DataKeepsTheNewest) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  int value = -1;
  EXPECT_EQ(out.write(0), WriteResult::NotConnected);
  const auto connection = connected(out, in);
  EXPECT_EQ(in.read(value), ReadStatus::NoData);
  EXPECT_EQ(value, -1);
  for (int i = 1; i <= 3; ++i)
    EXPECT_EQ(out.write(i), WriteResult::Written);
  EXPECT_EQ(in.read(value), ReadStatus::NewData);
  EXPECT_EQ(value, 3);
  value = 0;
  EXPECT_EQ(in.read(value), ReadStatus::OldData);
  EXPECT_EQ(value, 3);
  const Counters counters = connection->counters();
  EXPECT_EQ(counters.written, 3U);
  EXPECT_EQ(counters.read, 1U);
  EXPECT_EQ(counters.overwritten, 2U);
  EXPECT_EQ(counters.dropped, 0U);
}

TEST_F(Local, HowLongSamplesWaitedIsMeasured) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, buffer(2));
  EXPECT_EQ(connection->latency(), Latency{});
  const TimePoint before = monotonic_now();
  out.write(1);
  const TimePoint written = monotonic_now();
  const TimePoint reading = monotonic_now();
  EXPECT_THAT(read_all(in), ElementsAre(1));
  const TimePoint after = monotonic_now();
  const Latency latency = connection->latency();
  EXPECT_EQ(latency.measured, 1U);
  EXPECT_GE(latency.mean, reading - written);
  EXPECT_LE(latency.mean, after - before);
  EXPECT_EQ(latency.worst, latency.mean);
}

TEST_F(Local, OfAFastWriterSomeSamplesAreMeasured) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, buffer(1000));
  for (int i = 0; i < 1000; ++i)
    out.write(i);
  EXPECT_EQ(read_all(in).size(), 1000U);
  EXPECT_GE(connection->latency().measured, 1000U / task::detail::SampleStamps::kMostStride);
  EXPECT_LE(connection->latency().measured, 1000U);
}

TEST_F(Local, BufferRefusesTheNewestAndCounts) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, buffer(2));
  EXPECT_EQ(out.write(1), WriteResult::Written);
  EXPECT_EQ(out.write(2), WriteResult::Written);
  EXPECT_EQ(out.write(3), WriteResult::Refused);
  EXPECT_THAT(read_all(in), ElementsAre(1, 2));
  EXPECT_EQ(connection->counters().dropped, 1U);
}

TEST_F(Local, CircularBufferDropsTheOldestAndCounts) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, circular(2));
  for (int i = 1; i <= 5; ++i)
    EXPECT_EQ(out.write(i), WriteResult::Written);
  EXPECT_THAT(read_all(in), ElementsAre(4, 5));
  EXPECT_EQ(connection->counters().dropped, 3U);
}

TEST_F(Local, NewReaderSeesTheLastValueIfAskedTo) {
  OutputPort<int> out(writer, "out");
  InputPort<int> with(reader, "with");
  InputPort<int> without(reader, "without");
  out.write(7);
  const auto connection = connected(out, with, {.kind = BufferKind::Data, .init = true});
  connected(out, without);
  int value = 0;
  EXPECT_EQ(with.read(value), ReadStatus::NewData);
  EXPECT_EQ(value, 7);
  EXPECT_EQ(connection->latency(), Latency{}) << "how long it has been there is no delay";
  EXPECT_EQ(without.read(value), ReadStatus::NoData);
  out.write(8);
  EXPECT_EQ(with.read(value), ReadStatus::NewData);
  EXPECT_EQ(value, 8);
}

TEST_F(Local, PortThatKeepsNothingHasNothingForANewReader) {
  OutputPort<int> out(writer, "out", {.keep_last = false});
  InputPort<int> in(reader, "in");
  out.write(7);
  connected(out, in, {.kind = BufferKind::Data, .init = true});
  int value = 0;
  EXPECT_EQ(in.read(value), ReadStatus::NoData);
}

TEST_F(Local, SampleFansOutWithoutACopy) {
  OutputPort<demo::Image> out(writer, "out");
  std::vector<std::unique_ptr<InputPort<demo::Image>>> inputs;
  for (int i = 0; i < 10; ++i) {
    inputs.push_back(std::make_unique<InputPort<demo::Image>>(reader, "in" + std::to_string(i)));
    connected(out, *inputs.back(), i % 2 == 0 ? kData : buffer(2));
  }
  auto loan = out.loan();
  ASSERT_TRUE(loan);
  loan->pixels.assign(1'000'000, 42);
  const demo::Image* written = &*loan;
  EXPECT_EQ(loan.publish(), WriteResult::Written);
  EXPECT_FALSE(loan);
  EXPECT_EQ(loan.publish(), WriteResult::NoSlot);
  for (const auto& input : inputs) {
    const Sample<demo::Image> sample = input->take();
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample.get(), written);
  }
}

TEST_F(Local, LatestReadsAllThatWaitsAndKeepsTheNewest) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, buffer(3));
  EXPECT_FALSE(in.latest());
  for (const int value : {1, 2, 3})
    out.write(value);
  for (int again = 0; again < 2; ++again) {
    const Sample<int> newest = in.latest();
    ASSERT_TRUE(newest);
    EXPECT_EQ(*newest, 3);
  }
  EXPECT_FALSE(in.take());
  EXPECT_EQ(in.samples_read(), 3U);
  connection->disconnect();
  EXPECT_FALSE(in.latest());
}

TEST_F(Local, FanInTakesTurnsAndKeepsEachOrder) {
  OutputPort<int> one(writer, "one");
  OutputPort<int> two(writer, "two");
  InputPort<int> in(reader, "in");
  connected(one, in, buffer(3));
  connected(two, in, buffer(3));
  for (const int value : {1, 2, 3})
    one.write(value);
  for (const int value : {10, 20, 30})
    two.write(value);
  EXPECT_THAT(read_all(in), ElementsAre(1, 10, 2, 20, 3, 30));
}

TEST_F(Local, ReadersThatHoldEverySlotCostTheWriterItsSampleAndNoMore) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  connected(out, in);
  std::vector<Sample<int>> held;
  WriteResult result = WriteResult::Written;
  for (int i = 0; i < 100 && result == WriteResult::Written; ++i) {
    result = out.write(i);
    if (result == WriteResult::Written) held.push_back(in.take());
  }
  EXPECT_EQ(result, WriteResult::NoSlot);
  EXPECT_EQ(out.exhausted(), 1U);
  for (std::size_t i = 0; i < held.size(); ++i)
    EXPECT_EQ(*held[i], static_cast<int>(i));
  held.clear();
  EXPECT_EQ(out.write(1), WriteResult::Written);
}

TEST_F(Local, AbandonedLoanGivesItsSlotBack) {
  OutputPort<int> out(writer, "out");
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(out.loan());
}

TEST_F(Local, NothingIsDeliveredAfterDisconnect) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  const auto connection = connected(out, in, buffer(5));
  int value = 0;
  out.write(1);
  out.write(2);
  ASSERT_EQ(in.read(value), ReadStatus::NewData);
  connection->disconnect();
  EXPECT_FALSE(connection->connected());
  EXPECT_FALSE(in.connected());
  EXPECT_FALSE(out.connected());
  EXPECT_EQ(in.read(value), ReadStatus::NoData) << "neither the one that waited nor the old one";
  EXPECT_EQ(out.write(3), WriteResult::NotConnected);
  connection->disconnect();
}

TEST_F(Local, AnEndedConnectionKeepsNoSamples) {
  // How many samples readers can hold after so many have waited in a connection that has ended.
  const auto available_after = [this](int waiting) {
    OutputPort<int> out(writer, "out");
    InputPort<int> in(reader, "in");
    const auto ended = connected(out, in, buffer(20));
    for (int i = 0; i < waiting; ++i)
      out.write(i);
    ended->disconnect();
    connected(out, in);
    std::vector<Sample<int>> held;
    while (out.write(0) == WriteResult::Written)
      held.push_back(in.take());
    return held.size();
  };
  EXPECT_EQ(available_after(20), available_after(0));
}

TEST_F(Local, OldDataOfOtherConnectionsStays) {
  OutputPort<int> one(writer, "one");
  OutputPort<int> two(writer, "two");
  InputPort<int> in(reader, "in");
  connected(one, in);
  const auto second = connected(two, in);
  one.write(1);
  int value = 0;
  ASSERT_EQ(in.read(value), ReadStatus::NewData);
  second->disconnect();
  EXPECT_EQ(in.read(value), ReadStatus::OldData);
  EXPECT_EQ(value, 1);
}

TEST_F(Local, PortsMayBeDestroyedWhileConnected) {
  auto out = std::make_unique<OutputPort<int>>(writer, "out");
  InputPort<int> in(reader, "in");
  auto gone = std::make_unique<InputPort<int>>(reader, "gone");
  const auto first = connected(*out, in);
  const auto second = connected(*out, *gone);
  out->write(5);
  gone.reset();
  EXPECT_FALSE(second->connected());
  EXPECT_EQ(out->write(6), WriteResult::Written);
  const Sample<int> held = in.take();
  out.reset();
  EXPECT_FALSE(first->connected());
  EXPECT_EQ(*held, 6) << "a sample outlives its port";
  first->disconnect();
}

TEST_F(Local, SameConnectionTwiceIsRefusedAnotherPolicyIsNot) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  connected(out, in);
  auto again = connect(out, in, kData);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::AlreadyExists);
  EXPECT_EQ(in.connection_count(), 1U);
  EXPECT_TRUE(connect(out, in, buffer(3)));
}

TEST_F(Local, TypesThatDifferAreRefusedWithBothDefinitions) {
  OutputPort<demo::Pose> out(writer, "out");
  InputPort<demo::Image> in(reader, "in");
  auto made = connect(out, in, kData);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::TypeMismatch);
  EXPECT_THAT(made.error().message, HasSubstr("/demo/Pose"));
  EXPECT_THAT(made.error().message, HasSubstr("pixels"));
}

TEST_F(Local, PortsOfOneTopicAreNotConnected) {
  const type::TypeInfo& type = type::type_info<int>();
  task::OutputPortBase out(writer, "out", &type, "", task::PortOptions{.topic = "topic /a"});
  task::InputPortBase in(reader, "in", &type, "", task::PortOptions{.topic = "topic /a"});
  task::InputPortBase other(reader, "other", &type, "", task::PortOptions{.topic = "topic /b"});
  const auto made = connect(out, in, kData);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::AlreadyExists);
  EXPECT_THAT(made.error().message, HasSubstr("out and in are both topic /a"));
  EXPECT_TRUE(connect(out, other, kData));
}

TEST_F(Local, TypeOfSameNameAndOtherStructureIsRefused) {
  const type::TypeInfo& mine = type::type_info<demo::Pose>();
  type::TypeInfo other = mine;
  other.hash ^= 1;
  OutputPort<demo::Pose> out(writer, "out");
  InputPortBase in(reader, "in", &other);
  EXPECT_EQ(connect(out, in, kData).error().code, ErrorCode::TypeMismatch);
}

TEST_F(Local, PoliciesThatMakeNoSenseAreRefused) {
  OutputPort<int> out(writer, "out");
  InputPort<int> in(reader, "in");
  EXPECT_EQ(connect(out, in, buffer(0)).error().code, ErrorCode::InvalidArgument);
  for (const BufferKind kind : {BufferKind::Buffer, BufferKind::CircularBuffer}) {
    EXPECT_TRUE(check_policy({.kind = kind, .size = 1'000'000}));
    EXPECT_EQ(connect(out, in, {.kind = kind, .size = 1'000'001}).error().code, ErrorCode::InvalidArgument)
        << "a reader would not notice that it was overtaken";
  }
  EXPECT_EQ(connect(out, in, {.kind = BufferKind::Data, .size = 2}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(connect(out, in, {.kind = BufferKind::Buffer, .size = 2, .init = true}).error().code,
            ErrorCode::InvalidArgument);
  EXPECT_EQ(connect(out, in, {.transport = Transport::Dds}).error().code, ErrorCode::Unsupported);
}

TEST_F(Local, PortsOfAnyTypeCountAndDrop) {
  OutputPort<demo::Pose> out(writer, "out");
  InputPortBase any(reader, "any", nullptr, "/rock/Unknown");
  connected(out, any, buffer(10));
  for (int i = 0; i < 4; ++i)
    out.write({1, 2});
  type::Value value;
  EXPECT_EQ(any.read_value(value), ReadStatus::NewData);
  EXPECT_EQ(value, type::Value::map({{"x", 1}, {"y", 2}}));
  EXPECT_EQ(any.drain(), 3U);
  EXPECT_EQ(any.samples_read(), 4U);
  EXPECT_EQ(any.type_name(), "/rock/Unknown");
}

TEST_F(Local, UntypedSamplesReadAsDefaultValues) {
  OutputPortBase untyped(writer, "untyped", nullptr, "/rock/Unknown");
  InputPort<demo::Pose> in(reader, "in");
  connected(untyped, in, buffer(2));
  EXPECT_EQ(untyped.write_default(), WriteResult::Written);
  demo::Pose pose{3, 4};
  EXPECT_EQ(in.read(pose), ReadStatus::NewData);
  EXPECT_EQ(pose.x, 0);
  EXPECT_EQ(untyped.write_default(), WriteResult::Written);
  EXPECT_EQ(in.take()->y, 0);
}

TEST_F(Local, PortsKnownByTypeInfoOnlyWriteDefaultsAndValues) {
  OutputPortBase out(writer, "out", &type::type_info<demo::Pose>());
  InputPort<demo::Pose> in(reader, "in");
  connected(out, in, buffer(4));
  ASSERT_TRUE(out.write_value(type::Value::map({{"x", 5}, {"y", 6}})));
  EXPECT_EQ(out.write_default(), WriteResult::Written);
  EXPECT_EQ(in.take()->x, 5);
  EXPECT_EQ(in.take()->x, 0);
  auto wrong = out.write_value(type::Value::map({{"x", "far"}}));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(out.write_default(), WriteResult::Written) << "its slot came back";
}

TEST_F(Local, PrimedPortKeepsItsCapacity) {
  OutputPort<std::vector<int>> out(writer, "out");
  out.prime(std::vector<int>(1000));
  for (int i = 0; i < 10; ++i) {
    auto loan = out.loan();
    EXPECT_GE(loan->capacity(), 1000U);
    loan->assign(10, i);
    loan.publish();
  }
}

/// Holds up whoever notifies it.
struct HeldListener final : task::SampleListener {
  std::latch inside{1};
  std::latch go_on{1};
  std::atomic<bool> left{false};
  std::shared_ptr<task::ManualExecutor> executor;

  void sample_arrived() noexcept override {
    inside.count_down();
    go_on.wait();
    left = true;
  }
  [[nodiscard]] task::Executor& runner() noexcept override { return *executor; }
};

/// A task that is renewed is destroyed as soon as its ports have another listener.
TEST_F(Local, NobodyNotifiesAListenerThatWasReplaced) {
  OutputPort<int> out{writer, "out"};
  InputPort<int> in{reader, "in"};
  ASSERT_NE(connected(out, in), nullptr);
  HeldListener listener;
  task::InputPortAccess::set_listener(in, &listener);
  std::thread writing([&] { out.write(1); });
  listener.inside.wait();
  segue::testing::WaitingCall replacing([&] {
    task::InputPortAccess::set_listener(in, nullptr);
    EXPECT_TRUE(listener.left) << "the writer still used it";
  });
  EXPECT_TRUE(replacing.waits());
  listener.go_on.count_down();
  replacing.join();
  writing.join();
}

}  // namespace
}  // namespace segue::sample_link
