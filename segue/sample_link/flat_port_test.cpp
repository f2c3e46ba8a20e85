// SPDX-License-Identifier: Apache-2.0
// Ports whose samples are in the flat layout, as those of gateways are.
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_test_support.hpp>
#include <segue/type/flat.hpp>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using task::PortOptions;
using task::SampleRef;
using task::SampleSlot;
using Text = std::vector<std::string>;

const type::TypeInfo& kTextType = type::type_info<Text>();

struct FlatOutput : task::OutputPortBase {
  explicit FlatOutput(Component& owner, const type::TypeInfo& info = kTextType)
      : OutputPortBase(owner, "out", &info, {}, PortOptions{.flat = true}) {}
  using OutputPortBase::acquire;
  using OutputPortBase::acquire_flat;
  using OutputPortBase::publish;

  WriteResult write(const Text& text) { return write_object(&text); }
};

struct FlatInput : task::InputPortBase {
  explicit FlatInput(Component& owner, const std::string& name = "in", const type::TypeInfo& info = kTextType)
      : InputPortBase(owner, name, &info, {}, PortOptions{.flat = true}) {}
  SampleRef take() noexcept { return fetch() == ReadStatus::NewData ? last() : SampleRef(); }
};

struct FlatSource : Component {
  FlatOutput out{*this};
};
struct FlatSink : Component {
  explicit FlatSink(const std::string& name = "in") : in(*this, name) {}
  FlatInput in;
};

Text text_of(int number) {
  return {std::to_string(number), std::string(static_cast<std::size_t>(number % 50), 'x')};
}

/// The text of a sample in either form.
Text text_of(const SampleRef& sample) {
  Text text;
  if (sample->flat_size == 0) return *static_cast<const Text*>(sample->value);
  EXPECT_TRUE(type::read_flat(kTextType, &text, sample->flat()));
  return text;
}

TEST(FlatPort, IsOneOnlyWhereObjectsHavePointers) {
  Component owner;
  EXPECT_TRUE(FlatOutput(owner).is_flat());
  EXPECT_TRUE(FlatInput(owner).is_flat());
  EXPECT_FALSE(FlatOutput(owner, type::type_info<Pose>()).is_flat());
  EXPECT_FALSE(task::OutputPortBase(owner, "any", nullptr, {}, PortOptions{.flat = true}).is_flat());
  EXPECT_FALSE(OutputPort<Text>(owner, "typed", PortOptions{.flat = true}).is_flat());
  EXPECT_FALSE(InputPort<Text>(owner, "typed", PortOptions{.flat = true}).is_flat());
}

TEST(FlatPort, SamplesAreWrittenAndReadInTheSharedMemory) {
  Pair pair;
  FlatSource source;
  FlatSink one("one");
  FlatSink two("two");
  ASSERT_TRUE(pair.connect(source.out, one.in, {BufferKind::Buffer, 4}).ok);
  ASSERT_TRUE(pair.connect(source.out, two.in, {}).ok);
  const std::size_t before = pair.writer->usage().payload_used;
  const Text text = {std::string(3000, 'x')};
  EXPECT_EQ(source.out.write(text), WriteResult::Written);
  EXPECT_EQ(pair.writer->usage().payload_used, before + 4096) << "one block, for both and the port";
  const SampleRef sample = one.in.take();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->flat_size, type::flat_size(kTextType, &text));
  EXPECT_EQ(text_of(sample), text);
  EXPECT_EQ(sample->sequence, 1U);
  const SampleRef other = two.in.take();
  ASSERT_TRUE(other);
  EXPECT_EQ(other->value, sample->value);
}

TEST(FlatPort, SamplesOfObjectsAreReadInTheSharedMemory) {
  Pair pair;
  Source<Text> source;
  FlatSink sink;
  const Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  source.out.write(text_of(7));
  source.out.write(text_of(8));
  const SampleRef first = sink.in.take();
  const SampleRef second = sink.in.take();
  ASSERT_TRUE(first && second);
  EXPECT_GT(first->flat_size, 0U);
  EXPECT_EQ(text_of(first), text_of(7));
  EXPECT_EQ(text_of(second), text_of(8));
  EXPECT_EQ(link.output->counters().read, 2U);
}

/// Connects ports of one process or of two.
struct Way {
  const char* name;
  std::function<std::shared_ptr<PortConnection>(Pair&, task::OutputPortBase&, task::InputPortBase&,
                                                const Policy&)>
      connect;
};

const Way kWays[] = {
    {"local", [](Pair&, task::OutputPortBase& from, task::InputPortBase& to,
                 const Policy& policy) { return sample_link::connect(from, to, policy).value(); }},
    {"shared", [](Pair& pair, task::OutputPortBase& from, task::InputPortBase& to, const Policy& policy) {
       return std::shared_ptr<PortConnection>(pair.connect(from, to, policy).output);
     }}};

const Policy kPolicies[] = {{}, {BufferKind::Buffer, 3}, {BufferKind::CircularBuffer, 3}};

/// A writer and a reader; the same random writes and reads of each pair must do the same.
struct Walk {
  std::function<WriteResult(const Text&)> write;
  std::function<std::optional<Text>()> read;
  std::shared_ptr<PortConnection> connection;
  std::vector<std::string> record{};

  void step(bool writes, int number) {
    if (writes) {
      record.push_back("write " + std::to_string(static_cast<int>(write(text_of(number)))));
    } else {
      const auto got = read();
      record.push_back("read " + (got ? got->at(0) + got->at(1) : "nothing"));
    }
    const Counters now = connection->counters();
    record.back() += " " + std::to_string(now.written) + " " + std::to_string(now.read) + " " +
                     std::to_string(now.dropped) + " " + std::to_string(now.overwritten);
  }
};

template <class From>
std::function<WriteResult(const Text&)> writer_of(From& source) {
  return [&source](const Text& text) { return source.out.write(text); };
}

std::function<std::optional<Text>()> reader_of(Sink<Text>& sink) {
  return [&sink]() -> std::optional<Text> {
    const auto sample = sink.in.take();
    return sample ? std::optional(*sample) : std::nullopt;
  };
}

std::function<std::optional<Text>()> reader_of(FlatSink& sink) {
  return [&sink]() -> std::optional<Text> {
    const SampleRef sample = sink.in.take();
    return sample ? std::optional(text_of(sample)) : std::nullopt;
  };
}

TEST(FlatPort, SamplesAndCountersAreThoseOfObjects) {
  for (const Way& way : kWays) {
    for (const Policy& policy : kPolicies) {
      Pair pair;
      Source<Text> objects;
      Source<Text> objects_for_flat;
      FlatSource flat;
      FlatSource flat_for_objects;
      Sink<Text> object_sink;
      Sink<Text> sink_of_flat;
      FlatSink flat_sink;
      FlatSink flat_sink_of_objects;
      std::vector<Walk> walks;
      const auto add = [&](auto& from, auto& to) {
        walks.push_back({writer_of(from), reader_of(to), way.connect(pair, from.out, to.in, policy)});
      };
      add(objects, object_sink);
      add(flat, flat_sink);
      add(flat_for_objects, sink_of_flat);
      add(objects_for_flat, flat_sink_of_objects);
      std::mt19937 random(7);
      for (int i = 1; i < 1000; ++i) {
        const bool writes = random() % 2 == 0;
        for (Walk& walk : walks)
          walk.step(writes, i);
      }
      for (const Walk& walk : walks)
        EXPECT_EQ(walk.record, walks.front().record) << way.name << ", policy " << to_string(policy.kind);
    }
  }
}

TEST(FlatPort, ANewReaderGetsTheLastSampleIfItAsksForIt) {
  const Policy init{BufferKind::Data, 1, Transport::Automatic, true};
  for (const Way& way : kWays) {
    Pair pair;
    FlatSource source;
    source.out.write(text_of(5));  // nobody is there, so it does not lie in the shared memory
    Sink<Text> sink;
    way.connect(pair, source.out, sink.in, init);
    Text text;
    EXPECT_EQ(sink.in.read(text), ReadStatus::NewData) << way.name;
    EXPECT_EQ(text, text_of(5));
    source.out.write(text_of(6));  // now it may
    FlatSink later("later");
    way.connect(pair, source.out, later.in, init);
    const SampleRef sample = later.in.take();
    ASSERT_TRUE(sample) << way.name;
    EXPECT_EQ(text_of(sample), text_of(6));
    EXPECT_EQ(sample->sequence, 2U);
  }
}

TEST(FlatPort, ReadersOfAllKindsShareASample) {
  Pair pair;
  FlatSource source;
  FlatSink flat_here("flat_here");
  FlatSink flat_there("flat_there");
  Sink<Text> here("here");
  Sink<Text> there("there");
  ASSERT_TRUE(connect(source.out, flat_here.in, {}));
  ASSERT_TRUE(connect(source.out, here.in, {}));
  ASSERT_TRUE(pair.connect(source.out, flat_there.in, {}).ok);
  ASSERT_TRUE(pair.connect(source.out, there.in, {}).ok);
  for (int i = 1; i <= 100; ++i) {
    ASSERT_EQ(source.out.write(text_of(i)), WriteResult::Written);
    EXPECT_EQ(text_of(flat_here.in.take()), text_of(i));
    EXPECT_EQ(text_of(flat_there.in.take()), text_of(i));
    EXPECT_EQ(*here.in.take(), text_of(i));
    EXPECT_EQ(*there.in.take(), text_of(i));
  }
}

TEST(FlatPort, ValuesAreWrittenAndRead) {
  FlatSource source;
  FlatSink sink;
  ASSERT_TRUE(connect(source.out, sink.in, {}));
  const Text text = text_of(9);
  const type::Value value = kTextType.to_value(&text);
  EXPECT_EQ(source.out.write_value(value).value(), WriteResult::Written);
  type::Value got;
  EXPECT_EQ(sink.in.read_value(got), ReadStatus::NewData);
  EXPECT_EQ(got, value);
  EXPECT_EQ(source.out.write_default(), WriteResult::Written);
  EXPECT_EQ(sink.in.read_value(got), ReadStatus::NewData);
  EXPECT_EQ(got, type::Value::list({}));
  EXPECT_FALSE(source.out.write_value(type::Value(5)));
}

TEST(FlatPort, NothingIsLeftInTheSharedMemory) {
  Pair pair;
  const std::size_t before = pair.writer->usage().payload_used;
  std::optional<FlatSource> source(std::in_place);
  std::optional<FlatSink> sink(std::in_place);
  for (int round = 0; round < 20; ++round) {
    const Link link = pair.connect(source->out, sink->in, {BufferKind::CircularBuffer, 3});
    ASSERT_TRUE(link.ok);
    for (int i = 0; i < 10; ++i)
      source->out.write({std::string(3000, 'x')});
    EXPECT_TRUE(sink->in.take());
    pair.disconnect(link);
    EXPECT_LE(pair.writer->usage().payload_used, before + 3 * 4096) << "the last one, and what is held";
  }
  sink.reset();
  source.reset();
  // The endpoints that have ended are dropped with the next connection.
  FlatSource other;
  FlatSink reader;
  pair.disconnect(pair.connect(other.out, reader.in, {}));
  EXPECT_EQ(pair.writer->usage().payload_used, before);
}

TEST(FlatPort, AFullPoolRefusesWhatOthersWithinTheProcessCanHave) {
  Pair pair({std::size_t{1} << 16, std::size_t{1} << 18, std::size_t{1} << 20});
  FlatSource source;
  FlatSink sink;
  Sink<Text> local("local");
  const Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 100});
  ASSERT_TRUE(link.ok);
  ASSERT_TRUE(connect(source.out, local.in, {}));
  const Text large = {std::string(60'000, 'x')};
  int taken = 0;
  while (source.out.write(large) == WriteResult::Written)
    ++taken;
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 4);
  EXPECT_EQ(link.output->counters().dropped, 1U);
  EXPECT_EQ(*local.in.take(), large);
  for (int i = 0; i < taken; ++i)
    EXPECT_TRUE(sink.in.take());
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(source.out.write(large), WriteResult::Written) << "room came back";
}

TEST(FlatPort, AReaderThatKeepsSamplesStarvesOnlyItself) {
  for (const Way& way : kWays) {
    Pair pair;
    FlatSource source;
    FlatSink greedy("greedy");
    Sink<Text> greedy_too("greedy_too");
    Sink<Text> modest("modest");
    for (task::InputPortBase* in : std::initializer_list<task::InputPortBase*>{&greedy.in, &greedy_too.in})
      way.connect(pair, source.out, *in, {BufferKind::Buffer, 2});
    way.connect(pair, source.out, modest.in, {});
    std::vector<SampleRef> kept;
    std::vector<Sample<Text>> kept_too;
    for (int i = 1; i < 6; ++i) {
      EXPECT_NE(source.out.write(text_of(i)), WriteResult::NoSlot) << way.name;
      if (SampleRef sample = greedy.in.take()) kept.push_back(std::move(sample));
      if (auto sample = greedy_too.in.take()) kept_too.push_back(std::move(sample));
      EXPECT_EQ(*modest.in.take(), text_of(i));
    }
    for (std::size_t i = 0; i < kept.size(); ++i)
      EXPECT_EQ(text_of(kept[i]), text_of(static_cast<int>(i) + 1));
    for (std::size_t i = 0; i < kept_too.size(); ++i)
      EXPECT_EQ(*kept_too[i], text_of(static_cast<int>(i) + 1));
  }
}

TEST(FlatPort, BytesThatLieAreCountedAndDropped) {
  Pair pair;
  Source<std::array<std::int64_t, 40>> source;  // raw bytes, which the reader takes for a text
  FlatSink sink;
  auto origin = describe_output(*pair.writer, source.out);
  origin.flat = true;
  const auto input = open_input(*pair.reader, origin, sink.in, {BufferKind::Buffer, 8});
  ASSERT_TRUE(input);
  InputPlace place = input->place;
  place.type = source.out.type()->name();
  place.hash = source.out.type()->hash;
  const auto output = attach_output(*pair.writer, place, source.out, {BufferKind::Buffer, 8});
  ASSERT_TRUE(output);
  std::array<std::int64_t, 40> lie{};
  std::uint64_t corrupt = 0;
  for (const std::int64_t count : {std::int64_t{41}, std::int64_t{1} << 40, std::int64_t{-1}}) {
    lie.fill(count);
    source.out.write(lie);
    EXPECT_FALSE(sink.in.take());
    EXPECT_EQ(input->endpoint->corrupt(), ++corrupt);
  }
  lie.fill(0);
  lie[0] = 39;  // that many empty words
  source.out.write(lie);
  const SampleRef sample = sink.in.take();
  ASSERT_TRUE(sample);
  EXPECT_EQ(text_of(sample), Text(39));
  EXPECT_EQ(input->endpoint->corrupt(), corrupt);
}

/// Every word of a sample names it, so that no torn one goes unnoticed.
struct Seen {
  std::uint64_t last = 0;
  bool whole = true;
  bool in_order = true;

  void add(std::uint64_t sequence, const Text& text) {
    whole = whole && text == Text(sequence % 40, std::to_string(sequence));
    in_order = in_order && sequence > last;
    last = sequence;
  }
};

TEST(FlatPortStorm, ReadersComeAndGoWhileSamplesAreWritten) {
  Pair pair({std::size_t{1} << 16, std::size_t{1} << 22, std::size_t{1} << 22});
  FlatSource source;
  FlatSink flat("flat");
  Sink<Text> objects("objects");
  std::atomic<bool> ends{false};
  std::thread writer([&] {
    for (std::uint64_t sequence = 1; !ends; ++sequence)
      source.out.write(Text(sequence % 40, std::to_string(sequence)));
  });
  for (int round = 0; round < 24; ++round) {
    const Policy& policy = kPolicies[round % 3];
    const bool shared = round % 2 == 0;
    std::optional<Link> first;
    std::optional<Link> second;
    std::vector<std::shared_ptr<PortConnection>> local;
    if (shared) {
      first = pair.connect(source.out, flat.in, policy);
      second = pair.connect(source.out, objects.in, policy);
    } else {
      local = {connect(source.out, flat.in, policy).value(), connect(source.out, objects.in, policy).value()};
    }
    Seen seen_flat;
    Seen seen_objects;
    int count = 0;
    const bool done = eventually([&] {
      if (const SampleRef sample = flat.in.take()) {
        seen_flat.add(sample->sequence, text_of(sample));
        ++count;
      }
      if (const auto sample = objects.in.take()) seen_objects.add(sample.sequence(), *sample);
      return count >= 50 && seen_objects.last > 0;
    });
    EXPECT_TRUE(done) << "round " << round;
    EXPECT_TRUE(seen_flat.whole && seen_flat.in_order && seen_objects.whole && seen_objects.in_order);
    if (shared) {
      pair.disconnect(*first);
      pair.disconnect(*second);
    }
    for (const auto& connection : local)
      connection->disconnect();
    if (!done) break;
  }
  ends = true;
  writer.join();
}

}  // namespace
}  // namespace segue::sample_link
