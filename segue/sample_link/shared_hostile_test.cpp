// SPDX-License-Identifier: Apache-2.0
// A hostile peer that writes anything to the memory that it shares.
#include <segue/sample_link/shared_pools.hpp>
#include <segue/sample_link/shared_ring.hpp>
#include <segue/sample_link/shared_test_support.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace shared_hostile_test {

enum class Mode : std::uint8_t { Slow, Medium, Fast };
struct Switches {
  bool on = false;
  Mode mode = Mode::Slow;
};

SEGUE_TYPE(Mode, Slow, Medium, Fast)
SEGUE_TYPE(Switches, on, mode)

}  // namespace shared_hostile_test

namespace segue::sample_link {
namespace {

using shared_hostile_test::Mode;
using shared_hostile_test::Switches;

using namespace shared_test;
using Text = std::vector<std::string>;

/// The whole control pool of a process, as a peer sees it.
struct Hostile {
  explicit Hostile(const SharedMemory& victim) : offer(*victim.offer()), memory(*PeerMemory::map(offer)) {}
  [[nodiscard]] SharedRing ring(const InputPlace& place, const Policy& policy) const {
    return {memory->control(place.offset, SharedRing::bytes(policy)), policy, place.generation};
  }
  MemoryOffer offer;
  std::shared_ptr<const PeerMemory> memory;
};

/// A connection, and its ring as a hostile peer sees it.
template <typename T>
struct Attacked {
  explicit Attacked(const Policy& policy)
      : hostile(*pair.reader),
        link(pair.connect(source.out, sink.in, policy)),
        ring(hostile.ring(link.place, policy)) {
    EXPECT_TRUE(link.ok);
  }
  Pair pair;
  Hostile hostile;
  Source<T> source;
  Sink<T> sink;
  Link link;
  SharedRing ring;
};

/// Seals the entry, as a writer does that lies on purpose.
void seal(const SharedRing& ring, std::size_t index) {
  RingEntry& entry = ring.entries()[index];
  entry.seal = ring.seal_of(index, entry.offset, entry.size, entry.sequence);
}

/// The damage that an endpoint finds in the course of some seconds, during which nothing is written.
template <class Endpoint>
Damage damage_of(Endpoint& endpoint) {
  TimePoint now(std::chrono::hours(1));
  for (int look = 0; look < 4; ++look, now += std::chrono::seconds(1)) {
    if (const Damage found = endpoint.damage(now); found != Damage::None) return found;
  }
  return Damage::None;
}

TEST(SharedHostile, WordsThatMakeNoSenseAreCountedAndDropped) {
  for (const Policy policy :
       {Policy{}, Policy{BufferKind::Buffer, 4}, Policy{BufferKind::CircularBuffer, 4}}) {
    Attacked<Pose> attacked(policy);
    auto& [pair, hostile, source, sink, link, ring] = attacked;
    std::uint64_t before = 0;
    ring.words().push(0x3ffffffffff, before);  // no such mark
    EXPECT_FALSE(sink.in.take());
    EXPECT_EQ(link.input->corrupt(), 1U);
  }
}

TEST(SharedHostile, TimesThatLieAreNotMeasured) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 8});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  for (const std::uint64_t time : {std::uint64_t{1} << 62, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    ASSERT_EQ(source.out.write(Pose(1)), WriteResult::Written);
    for (RingEntry& entry : ring.entries())
      entry.written_at = time;
    EXPECT_TRUE(sink.in.take());
    EXPECT_EQ(link.input->latency(), Latency{});
  }
}

TEST(SharedHostile, EntriesThatLieAreCountedAndDropped) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 8});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  struct Lie {
    std::uint64_t offset;
    std::uint64_t size;
  };
  const std::vector<Lie> lies = {{~std::uint64_t{0}, sizeof(Pose)},
                                 {~std::uint64_t{0} - 255, sizeof(Pose)},
                                 {(1 << 24) - 8, sizeof(Pose)},
                                 {~std::uint64_t{0} - 7, sizeof(Pose)},
                                 {65, sizeof(Pose)},
                                 {64, sizeof(Pose) - 1},
                                 {64, ~std::uint64_t{0}},
                                 {64, 0}};
  std::uint64_t expected = 0;
  for (const Lie& lie : lies) {
    RingEntry& entry = ring.entries()[0];
    entry.offset = lie.offset;
    entry.size = lie.size;
    entry.sequence = 1;
    seal(ring, 0);
    std::uint64_t before = 0;
    ASSERT_EQ(ring.words().push(ring.token_of(0), before), WordRing::Push::Taken);
    EXPECT_FALSE(sink.in.take());
    EXPECT_EQ(link.input->corrupt(), ++expected);
  }
}

TEST(SharedHostile, EntriesThatAreHeldOrOfAnEarlierConnectionAreCountedAndDropped) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 8});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  // A second reference to the same entry, while the reader holds it.
  RingEntry& entry = ring.entries()[0];
  entry.offset = 64;
  entry.size = sizeof(Pose);
  entry.sequence = 1;
  seal(ring, 0);
  std::uint64_t before = 0;
  ring.words().push(ring.token_of(0), before);
  ring.words().push(ring.token_of(0), before);
  const auto held = sink.in.take();
  EXPECT_TRUE(held);
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.input->corrupt(), 1U);
  // An entry of a connection that had this place before.
  std::byte* pair_ring = hostile.memory->control(link.place.offset, 64);
  RingEntry& late = ring.entries()[1];
  late.offset = 128;
  late.size = sizeof(Pose);
  late.sequence = 2;
  late.seal = SharedRing(pair_ring, Policy{BufferKind::Buffer, 8}, link.place.generation + 1)
                  .seal_of(1, late.offset, late.size, late.sequence);
  ring.words().push(ring.token_of(1), before);
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.input->corrupt(), 2U);
}

TEST(SharedHostile, OlderSampleThatComesLateIsNotDelivered) {
  Attacked<Pose> attacked{Policy()};
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  for (int i = 1; i <= 5; ++i)
    source.out.write(Pose(i));
  EXPECT_EQ(*sink.in.take(), Pose(5));
  RingEntry& entry = ring.entries()[3];
  entry.offset = 128;
  entry.size = sizeof(Pose);
  entry.sequence = 3;
  seal(ring, 3);
  ASSERT_TRUE(ring.words().offer(ring.token_of(3)));
  EXPECT_FALSE(sink.in.take());
  entry.sequence = 6;
  seal(ring, 3);
  ASSERT_TRUE(ring.words().offer(ring.token_of(3)));
  EXPECT_TRUE(sink.in.take());
}

TEST(SharedHostile, FlatBytesThatLieAreCountedAndDropped) {
  const Policy policy{BufferKind::Buffer, 8};
  Attacked<Text> attacked(policy);
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  source.out.write({"one", "two"});
  for (std::size_t i = 0; i < ring.entries().size(); ++i) {
    ring.entries()[i].size = 12;  // truncated
    seal(ring, i);
  }
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.input->corrupt(), 1U);
  source.out.write({"three"});
  EXPECT_TRUE(sink.in.take()) << "the connection still works";
}

TEST(SharedHostile, ReaderThatGivesBackWhatItWasNeverGivenIsCounted) {
  const Policy policy{BufferKind::Buffer, 4};
  Attacked<Pose> attacked(policy);
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  for (int i = 1; i < 200; ++i) {
    for (auto& word : ring.returned())
      word = ~std::uint64_t{0};
    source.out.write(Pose(i));
    sink.in.take();
  }
  EXPECT_GT(link.output->corrupt(), 0U);
  const std::size_t used = pair.writer->usage().payload_used;
  pair.disconnect(link);
  EXPECT_EQ(pair.writer->usage().payload_used, used);
  Sink<Pose> other("other");
  ASSERT_TRUE(pair.connect(source.out, other.in, policy).ok);
  source.out.write(Pose(7));
  EXPECT_EQ(*other.in.take(), Pose(7)) << "nothing was given away twice";
}

/// Random writes to a control pool at any time cause no crash and no endless loop, and honest peers still get
/// intact samples.
TEST(SharedHostile, GarbageAnywhereInTheControlPoolHarmsNobodyElse) {
  std::minstd_rand random(7);
  for (int round = 0; round < 30; ++round) {
    Pair pair;
    const Hostile hostile(*pair.reader);
    const auto honest = *SharedMemory::create(kSmall);
    ASSERT_TRUE(honest->admit(*pair.writer->offer()));
    ASSERT_TRUE(pair.writer->admit(*honest->offer()));
    Source<Pose> source;
    Source<Text> texts;
    auto [task, counter] = running<Counter>("counter", {});
    Sink<Text> text_sink;
    Sink<Pose> good("good");
    const auto kind = static_cast<BufferKind>(round % 3);
    const Policy policy{kind, kind == BufferKind::Data ? 1U : 5U};
    ASSERT_TRUE(pair.connect(source.out, counter->in, policy).ok);
    ASSERT_TRUE(pair.connect(texts.out, text_sink.in, policy).ok);
    auto input = open_input(*honest, describe_output(*pair.writer, source.out), good.in, {});
    ASSERT_TRUE(input);
    ASSERT_TRUE(attach_output(*pair.writer, input->place, source.out, {}));
    auto* words = reinterpret_cast<std::atomic<std::uint64_t>*>(hostile.memory->control(0, 1 << 16));
    const std::size_t used = pair.reader->usage().control_used / 8;
    for (int i = 1; i <= 300; ++i) {
      for (int spoiled = 0; spoiled < 4; ++spoiled) {
        // The low bits only occasionally, so that most words stay plausible.
        const std::uint64_t garbage = std::uint64_t{random()} << (random() % 40);
        words[random() % used] ^= random() % 2 == 0 ? garbage : std::uint64_t{1} << (random() % 64);
      }
      source.out.write(Pose(i));
      texts.out.write({"text"});
      static_cast<void>(text_sink.in.take());
      const auto sample = good.in.take();
      ASSERT_TRUE(sample);
      ASSERT_EQ(*sample, Pose(i));
    }
    EXPECT_TRUE(task->stop(soon()));
  }
}

/// A boolean and an enum in a sample that travels as bytes.
TEST(SharedHostile, SamplesWithImpossibleBytesAreNotDelivered) {
  Attacked<Switches> attacked(Policy{BufferKind::Buffer, 4});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  source.out.write(Switches{true, Mode::Fast});
  EXPECT_TRUE(sink.in.take());
  EXPECT_EQ(damage_of(*link.input), Damage::None);
  for (const auto& [on, mode] : {std::pair{2, 0}, std::pair{1, 77}}) {
    auto sample = source.out.loan();
    ASSERT_TRUE(sample);
    std::memset(&sample->on, on, 1);
    std::memset(&sample->mode, mode, 1);
    sample.publish();
    EXPECT_FALSE(sink.in.take());
  }
  EXPECT_EQ(link.input->corrupt(), 2U);
  EXPECT_EQ(damage_of(*link.input), Damage::Payload);
  source.out.write(Switches{false, Mode::Slow});
  EXPECT_TRUE(sink.in.take());
}

TEST(SharedHostile, AHeaderThatWasOverwrittenIsNoticed) {
  for (int word = 0; word < 6; ++word) {
    Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
    auto& [pair, hostile, source, sink, link, ring] = attacked;
    source.out.write(Pose(1));
    EXPECT_EQ(damage_of(*link.input), Damage::None);
    auto& header = ring.header();
    const std::array<std::atomic<std::uint64_t>*, 6> words = {
        &header.generation, &header.closed, &header.size, &header.kind, &header.init, &header.doorbell};
    words.at(static_cast<std::size_t>(word))->fetch_xor(1);
    EXPECT_EQ(link.input->damage({}), Damage::Ring) << word;
  }
}

TEST(SharedHostile, ASampleThatWasErasedIsNoticed) {
  for (const BufferKind kind : {BufferKind::Buffer, BufferKind::CircularBuffer, BufferKind::Data}) {
    const Policy policy{kind, kind == BufferKind::Data ? 1U : 4U};
    Attacked<Pose> attacked(policy);
    auto& [pair, hostile, source, sink, link, ring] = attacked;
    source.out.write(Pose(1));
    EXPECT_EQ(damage_of(*link.output), Damage::None);
    EXPECT_NE(ring.words().remove(0), 0U);
    EXPECT_FALSE(sink.in.take());
    EXPECT_EQ(damage_of(*link.output), Damage::Ring);
  }
}

TEST(SharedHostile, ASampleThatWasErasedIsNoticedAlthoughOthersFlow) {
  Attacked<Pose> attacked{Policy()};
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  TimePoint now;
  Damage found = Damage::None;
  for (int i = 1; i <= 5; ++i, now += std::chrono::seconds(1)) {
    source.out.write(Pose(i));
    if (i == 1) {
      EXPECT_NE(ring.words().remove(0), 0U);
    }
    EXPECT_EQ(sink.in.take().get() != nullptr, i != 1);
    found = link.output->damage(now);
  }
  EXPECT_EQ(found, Damage::Ring);
}

TEST(SharedHostile, AnEntryThatWasNotTakenBackIsNoticed) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  for (int i = 1; i <= 2; ++i) {
    source.out.write(Pose(i));
    EXPECT_TRUE(sink.in.take());
  }
  EXPECT_EQ(damage_of(*link.input), Damage::None);
  EXPECT_NE(ring.returned()[0].exchange(0), 0U);
  EXPECT_EQ(damage_of(*link.input), Damage::Ring);
}

TEST(SharedHostile, CountsOfTheOtherSideAreNotBelieved) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  source.out.write(Pose(1));
  sink.in.take();
  auto& header = ring.header();
  for (auto* count : {&header.written, &header.dropped, &header.overwritten, &header.taken_back}) {
    EXPECT_EQ(damage_of(*link.output), Damage::None);
    *count ^= 1ULL << 40;
    EXPECT_EQ(damage_of(*link.output), Damage::Ring);
    *count ^= 1ULL << 40;
  }
  header.read ^= 1ULL << 40;
  EXPECT_EQ(damage_of(*link.input), Damage::Ring);
}

TEST(SharedHostile, ACountThatWasSetBackIsNoticed) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  source.out.write(Pose(1));
  ring.header().written = 0;
  EXPECT_EQ(damage_of(*link.output), Damage::Ring);
}

TEST(SharedHostile, ASealFitsNothingButWhatItWasMadeOf) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
  const SharedRing& ring = attacked.ring;
  const std::uint64_t seal = ring.seal_of(1, 64, 32, 5);
  EXPECT_NE(ring.seal_of(2, 64, 32, 5), seal) << "another entry";
  EXPECT_NE(ring.seal_of(1, 128, 32, 5), seal) << "another place";
  EXPECT_NE(ring.seal_of(1, 64, 40, 5), seal) << "another size";
  EXPECT_NE(ring.seal_of(1, 64, 32, 6), seal) << "another sequence";
}

TEST(SharedHostile, AnEntryThatTheReaderUsesIsNotTakenBackForTheOneThatWasReplaced) {
  Attacked<Pose> attacked{Policy()};
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  source.out.write(Pose(1));
  const auto held = sink.in.take();
  ASSERT_TRUE(held);
  const auto entries = ring.entries();
  const auto in_use = std::find_if(entries.begin(), entries.end(), [](const RingEntry& entry) {
    return entry.sequence == 1 && entry.size == sizeof(Pose);
  });
  ASSERT_NE(in_use, entries.end());
  source.out.write(Pose(2));
  ASSERT_NE(ring.words().remove(0), 0U);
  ASSERT_TRUE(ring.words().offer(ring.token_of(static_cast<std::size_t>(in_use - entries.begin()))));
  source.out.write(Pose(3));
  EXPECT_EQ(link.output->corrupt(), 1U);
}

TEST(SharedHostile, SamplesInAnotherOrderThanWrittenAreNotDelivered) {
  Attacked<Pose> attacked(Policy{BufferKind::Buffer, 4});
  auto& [pair, hostile, source, sink, link, ring] = attacked;
  for (int i = 1; i <= 4; ++i)
    source.out.write(Pose(i));
  EXPECT_NE(ring.words().remove(0), 0U);
  EXPECT_FALSE(sink.in.take());
  source.out.write(Pose(5));  // into the place of the first
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.input->damage({}), Damage::Ring);
}

TEST(SharedHostile, APoolWhoseHeaderWasOverwrittenCanBeMappedAgain) {
  Pair pair;
  const Hostile hostile(*pair.reader);
  reinterpret_cast<std::atomic<std::uint64_t>*>(hostile.memory->control(0, 64))[0] = 7;
  const auto late = *SharedMemory::create(kSmall);
  EXPECT_TRUE(late->admit(*pair.reader->offer()));
}

TEST(SharedHostile, AReaderWhoseDoorbellWasOverwrittenIsWoken) {
  Pair pair;
  const Hostile hostile(*pair.reader);
  Source<Pose> source;
  auto [task, counter] = running<Counter>("counter", {});
  const Link link = pair.connect(source.out, counter->in, {});
  ASSERT_TRUE(link.ok);
  const auto doorbell =
      DoorbellLine::of(hostile.ring(link.place, {}).header().doorbell.load(std::memory_order_relaxed));
  ASSERT_TRUE(doorbell);
  auto& words = *reinterpret_cast<task::DoorbellWords*>(
      hostile.memory->control(doorbell->offset, sizeof(task::DoorbellWords)));
  ASSERT_TRUE(eventually([&] { return words.sleeping % 4 != 0; }));
  words.sleeping = 0;  // as if it were awake
  source.out.write(Pose(1));
  for (int look = 0; look < 2; ++look)
    EXPECT_EQ(link.input->damage({}), Damage::None);
  EXPECT_TRUE(eventually([counter = counter] { return counter->last == 1; }));
}

}  // namespace
}  // namespace segue::sample_link
