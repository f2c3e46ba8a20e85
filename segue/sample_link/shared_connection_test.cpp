// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_test_support.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/thread_executor.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <deque>
#include <functional>
#include <latch>
#include <memory>
#include <string>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using Text = std::vector<std::string>;

TEST(SharedConnection, SamplesAreReadWhereTheWriterPutThem) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  for (int i = 1; i <= 3; ++i)
    EXPECT_EQ(source.out.write(Pose(i)), WriteResult::Written);
  for (int i = 1; i <= 3; ++i) {
    const auto sample = sink.in.take();
    ASSERT_TRUE(sample);
    EXPECT_EQ(*sample, Pose(i));
    EXPECT_EQ(sample.sequence(), static_cast<std::uint64_t>(i));
  }
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.output->counters().read, 3U);
  EXPECT_EQ(link.input->counters().written, 3U);
}

TEST(SharedConnection, TheReaderKnowsHowLongSamplesTook) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  EXPECT_EQ(link.input->latency(), Latency{});
  const TimePoint before = monotonic_now();
  source.out.write(Pose(1));
  const TimePoint written = monotonic_now();
  const TimePoint reading = monotonic_now();
  ASSERT_TRUE(sink.in.take());
  const TimePoint after = monotonic_now();
  const Latency latency = link.input->latency();
  EXPECT_EQ(latency.measured, 1U);
  EXPECT_GE(latency.mean, reading - written);
  EXPECT_LE(latency.mean, after - before);
  EXPECT_EQ(latency.worst, latency.mean);
  EXPECT_EQ(link.output->latency(), Latency{}) << "only the reader knows";
}

TEST(SharedConnection, TheLastSampleFromBeforeTheConnectionIsNotMeasured) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  source.out.write(Pose(1));
  Link link = pair.connect(source.out, sink.in, {.kind = BufferKind::Data, .init = true});
  ASSERT_TRUE(link.ok);
  ASSERT_TRUE(sink.in.take());
  EXPECT_EQ(link.input->latency(), Latency{});
}

TEST(SharedConnection, SamplesWithPointersTravelFlat) {
  Pair pair;
  Source<Text> source;
  Sink<Text> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  const Text value = {"one", "", std::string(1000, 'x')};
  source.out.write(value);
  Text got;
  ASSERT_EQ(sink.in.read(got), ReadStatus::NewData);
  EXPECT_EQ(got, value);
  got.clear();
  EXPECT_EQ(sink.in.read(got), ReadStatus::OldData);
  EXPECT_EQ(got, value);
}

TEST(SharedConnection, SamplesOfAnyTypeOnlyCount) {
  Pair pair;
  Source<Pose> source;
  Component owner;
  task::InputPortBase any(owner, "any", nullptr);
  ASSERT_TRUE(pair.connect(source.out, any, {BufferKind::Buffer, 4}).ok);
  source.out.write(Pose(1));
  type::Value value;
  EXPECT_EQ(any.read_value(value), ReadStatus::NewData);
  EXPECT_EQ(value, type::Value{});

  task::OutputPortBase untyped(owner, "untyped", nullptr);
  Sink<Pose> sink;
  ASSERT_TRUE(pair.connect(untyped, sink.in, {}).ok);
  untyped.write_default();
  const auto sample = sink.in.take();
  ASSERT_TRUE(sample);
  EXPECT_EQ(*sample, Pose());
}

/// A reference model of a connection, as simple as possible.
struct Model {
  Policy policy;
  std::deque<std::int64_t> waiting;
  Counters counters;

  WriteResult write(std::int64_t value) {
    ++counters.written;
    if (waiting.size() == policy.size) {
      if (policy.kind == BufferKind::Buffer) {
        ++counters.dropped;
        return WriteResult::Refused;
      }
      waiting.pop_front();
      ++(policy.kind == BufferKind::Data ? counters.overwritten : counters.dropped);
    }
    waiting.push_back(value);
    return WriteResult::Written;
  }
};

template <class T>
T sample_of(std::int64_t number) {
  if constexpr (std::is_same_v<T, Pose>) {
    return Pose(number);
  } else {
    return {std::to_string(number), std::string(static_cast<std::size_t>(number % 50), 'x')};
  }
}

void expect_equal(const Counters& got, const Counters& wanted) {
  RC_ASSERT(got.written == wanted.written);
  RC_ASSERT(got.read == wanted.read);
  RC_ASSERT(got.dropped == wanted.dropped);
  RC_ASSERT(got.overwritten == wanted.overwritten);
}

template <class T>
void behaves_as_its_model() {
  static const Pair pair;
  const auto kind = *rc::gen::element(BufferKind::Data, BufferKind::Buffer, BufferKind::CircularBuffer);
  const auto size = kind == BufferKind::Data ? 1 : *rc::gen::inRange<std::size_t>(1, 80);
  const auto writes = *rc::gen::container<std::vector<bool>>(rc::gen::arbitrary<bool>());
  const std::size_t used = pair.writer->usage().payload_used;
  {
    Source<T> source;
    Sink<T> sink;
    Model model{{kind, size}, {}, {}};
    Link link = pair.connect(source.out, sink.in, model.policy);
    RC_ASSERT(link.ok);
    Sample<T> held;  // the component still holds the previous one
    std::int64_t next = 1;
    for (const bool is_write : writes) {
      if (is_write) {
        const WriteResult written = source.out.write(sample_of<T>(next));
        RC_ASSERT(written == model.write(next++));
        continue;
      }
      Sample<T> got = sink.in.take();
      RC_ASSERT(static_cast<bool>(got) == !model.waiting.empty());
      if (!got) continue;
      RC_ASSERT(*got == sample_of<T>(model.waiting.front()));
      model.waiting.pop_front();
      ++model.counters.read;
      held = got;
    }
    expect_equal(link.input->counters(), model.counters);
    expect_equal(link.output->counters(), model.counters);
    pair.disconnect(link);
    expect_equal(link.input->counters(), model.counters);
  }
  RC_ASSERT(pair.writer->usage().payload_used == used);
  RC_ASSERT(pair.writer->usage().connections == 0U);
}

RC_GTEST_PROP(SharedConnection, BehavesAsItsModel, ()) {
  behaves_as_its_model<Pose>();
}

RC_GTEST_PROP(SharedConnection, BehavesAsItsModelWithPointers, ()) {
  behaves_as_its_model<Text>();
}

TEST(SharedConnection, OnePayloadServesAllReaders) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> local;
  Sink<Pose> first;
  Sink<Pose> second("second");
  ASSERT_TRUE(pair.connect(source.out, first.in, {}).ok);
  ASSERT_TRUE(pair.connect(source.out, second.in, {}).ok);
  ASSERT_TRUE(connect(source.out, local.in, {}));
  const std::size_t used = pair.writer->usage().payload_used;
  auto loan = source.out.loan();
  *loan = Pose(5);
  const Pose* address = &*loan;
  loan.publish();
  EXPECT_EQ(local.in.take().get(), address);
  const auto one = first.in.take();
  const auto two = second.in.take();
  EXPECT_EQ(*one, Pose(5));
  EXPECT_EQ(one.get(), two.get()) << "both in the one map of the writer's pool";
  EXPECT_EQ(pair.writer->usage().payload_used, used) << "nothing was copied";
}

TEST(SharedConnection, SamplesWithPointersAreWrittenOnceForAllReaders) {
  Pair pair;
  Source<Text> source;
  std::vector<std::unique_ptr<Sink<Text>>> sinks;
  for (int i = 0; i < 3; ++i) {
    sinks.push_back(std::make_unique<Sink<Text>>(std::to_string(i)));
    ASSERT_TRUE(pair.connect(source.out, sinks.back()->in, {BufferKind::Buffer, 4}).ok);
  }
  const std::size_t before = pair.writer->usage().payload_used;
  source.out.write({std::string(3000, 'x')});
  EXPECT_EQ(pair.writer->usage().payload_used, before + 4096);
  for (const auto& sink : sinks)
    EXPECT_TRUE(sink->in.take());
}

TEST(SharedConnection, InitBringsTheLastSampleAndNeverAnOlderOne) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  source.out.write(Pose(1));  // its slot lies outside the pool
  Link link = pair.connect(source.out, sink.in, {BufferKind::Data, 1, Transport::Automatic, true});
  ASSERT_TRUE(link.ok);
  auto sample = sink.in.take();
  ASSERT_TRUE(sample);
  EXPECT_EQ(*sample, Pose(1));
  EXPECT_EQ(link.output->counters().written, 1U);
  for (int i = 2; i < 50; ++i) {
    source.out.write(Pose(i));
    sample = sink.in.take();
    ASSERT_TRUE(sample);
    EXPECT_EQ(*sample, Pose(i));
  }
}

TEST(SharedConnection, NothingIsDeliveredAfterTheReaderLeft) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  source.out.write(Pose(1));
  source.out.write(Pose(2));
  const auto held = sink.in.take();
  link.input->disconnect();
  Pose copy;
  EXPECT_EQ(sink.in.read(copy), ReadStatus::NoData);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(source.out.write(Pose(3)), WriteResult::Written) << "there is no reader, so it is not refused";
  EXPECT_EQ(*held, Pose(1)) << "what was taken stays";
  link.output->disconnect();
  for (int i = 0; i < 20; ++i)
    source.out.write(Pose(100 + i));
  EXPECT_EQ(*held, Pose(1)) << "and is not written to while it is held";
}

TEST(SharedConnection, WhatNobodyWillReadComesBack) {
  Pair pair;
  Source<Text> source;
  Sink<Text> sink;
  const std::size_t used = pair.writer->usage().payload_used;
  const Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  for (int i = 0; i < 4; ++i)
    source.out.write({"text"});
  link.output->disconnect();
  EXPECT_GT(pair.writer->usage().payload_used, used) << "the reader may still read";
  link.input->disconnect();
  EXPECT_EQ(pair.writer->usage().payload_used, used);
}

TEST(SharedConnection, ReadersThatLeftWithSamplesDoNotStarveTheWriter) {
  Pair pair;
  Source<Pose> source;
  std::vector<std::unique_ptr<Sink<Pose>>> sinks;
  std::vector<Sample<Pose>> held;
  for (int i = 0; i < 10; ++i) {
    sinks.push_back(std::make_unique<Sink<Pose>>());
    const Link link = pair.connect(source.out, sinks.back()->in, {});
    ASSERT_TRUE(link.ok);
    for (int j = 1; j <= 3; ++j) {
      EXPECT_EQ(source.out.write(Pose(j)), WriteResult::Written);
      held.push_back(sinks.back()->in.take());
      ASSERT_TRUE(held.back());
    }
    pair.disconnect(link);
  }
}

/// A port at the address of another one, whose samples have not all come back.
template <class Before, class After>
void replace_port(const Before& before, const After& after) {
  Pair pair;
  struct Holder : Component {
  } holder;
  union Place {
    Place() {}
    ~Place() {}
    OutputPort<Before> before;
    OutputPort<After> after;
  } place;
  Sink<Before> keeper("keeper");
  Sink<After> reader("reader");
  auto* const old = new (&place.before) OutputPort<Before>(holder, "out");
  Link first = pair.connect(*old, keeper.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(first.ok);
  ASSERT_EQ(old->write(before), WriteResult::Written);
  const auto kept = keeper.in.take();
  ASSERT_TRUE(kept);
  old->~OutputPort<Before>();
  auto* const next = new (&place.after) OutputPort<After>(holder, "out");
  Link second = pair.connect(*next, reader.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(second.ok) << to_string(second.error);
  ASSERT_EQ(next->write(after), WriteResult::Written);
  After got{};
  EXPECT_EQ(reader.in.read(got), ReadStatus::NewData);
  EXPECT_EQ(got, after);
  EXPECT_EQ(*kept, before);
  next->~OutputPort<After>();
}

TEST(SharedConnection, APortAtTheAddressOfAnotherOneSendsItsOwnSamples) {
  replace_port(Text{"old"}, Text{"new"});
  replace_port(Text{"old"}, std::vector<double>{1.5, 2.5});
  replace_port(Text{"old"}, Pose(5));
  replace_port(Pose(5), Text{"new"});
}

TEST(SharedConnection, WhatWaitsIsStillReadAfterTheWriterLeft) {
  Pair pair;
  Sink<Pose> sink;
  auto source = std::make_unique<Source<Pose>>();
  Link link = pair.connect(source->out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  source->out.write(Pose(1));
  source->out.write(Pose(2));
  source.reset();
  EXPECT_FALSE(link.output->connected());
  EXPECT_EQ(*sink.in.take(), Pose(1));
  EXPECT_EQ(*sink.in.take(), Pose(2));
}

TEST(SharedConnection, NothingIsLeftBehind) {
  Pair pair;
  Source<Pose> source;
  Source<Text> texts;
  Sink<Pose> sink;
  Sink<Text> text_sink;
  MemoryUsage writer;
  MemoryUsage reader;
  for (int round = 0; round < 50; ++round) {
    const Link one = pair.connect(source.out, sink.in, {});
    const Link two = pair.connect(texts.out, text_sink.in, {BufferKind::Buffer, 3});
    ASSERT_TRUE(one.ok && two.ok);
    for (int i = 0; i < 5; ++i) {
      source.out.write(Pose(i));
      texts.out.write({"text"});
    }
    sink.in.take();
    text_sink.in.take();
    pair.disconnect(one);
    pair.disconnect(two);
    // The samples of a port stay in the pool once it was connected, plus one slot, since the reader still
    // holds the sample that it took last when it is connected again.
    if (round != 1) continue;
    writer = pair.writer->usage();
    reader = pair.reader->usage();
  }
  EXPECT_EQ(pair.writer->usage().payload_used, writer.payload_used);
  EXPECT_EQ(pair.reader->usage().control_used, reader.control_used);
  EXPECT_EQ(pair.writer->usage().connections, 0U);
  EXPECT_EQ(pair.reader->usage().connections, 0U);
}

TEST(SharedConnection, PlaceThatIsNoneIsRefused) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  auto input = open_input(*pair.reader, describe_output(*pair.writer, source.out), sink.in, {});
  ASSERT_TRUE(input);
  const auto refused = [&](const std::function<void(InputPlace&)>& spoil, const Policy& policy = {}) {
    InputPlace place = input->place;
    spoil(place);
    return !attach_output(*pair.writer, place, source.out, policy);
  };
  EXPECT_TRUE(refused([](InputPlace& place) { place.reader += 1; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.offset += 64; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.offset += 1; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.offset = 0; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.offset = ~std::uint64_t{0} - 63; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.generation += 1; }));
  EXPECT_TRUE(refused([](InputPlace& place) { place.generation = 0; }));
  EXPECT_TRUE(refused([](InputPlace&) {}, {BufferKind::Buffer, 1}));
  EXPECT_TRUE(refused([](InputPlace&) {}, {BufferKind::Buffer, 1'000'000}));
  EXPECT_FALSE(refused([](InputPlace&) {}));
}

}  // namespace
}  // namespace segue::sample_link
