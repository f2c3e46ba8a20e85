// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/shared_pools.hpp>
#include <segue/sample_link/shared_test_support.hpp>

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <thread>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using Text = std::vector<std::string>;

/// Writes both kinds of samples as fast as it can.
struct Writer : Component {
  OutputPort<Pose> poses{*this, "poses"};
  OutputPort<Text> texts{*this, "texts"};

 protected:
  void on_update() override {
    for (int i = 0; i < 8; ++i) {
      poses.write(Pose(++count_));
      texts.write({std::to_string(count_), std::to_string(count_)});
    }
  }

 private:
  std::int64_t count_ = 0;
};

/// Takes all samples and counts violations.
struct Reader : Component {
  InputPort<Pose> poses{*this, "poses"};
  InputPort<Text> texts{*this, "texts"};
  std::atomic<int> connection{0};
  std::atomic<bool> closed{true};
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> wrong{0};
  std::atomic<std::uint64_t> unordered{0};
  std::atomic<std::uint64_t> ghosts{0};
  /// The writer may reuse the memory of samples that this reader holds.
  std::atomic<bool> given_up{false};

 protected:
  void on_update() override {
    const int number = connection;
    const bool was_closed = closed;
    bool any = false;
    Sample<Pose> before;
    while (Sample<Pose> pose = poses.take()) {
      any = true;
      if (before && before->number >= pose->number) ++unordered;
      if ((!pose->whole() || (before && !before->whole())) && !given_up) ++wrong;
      before = pose;
      ++received;
    }
    while (const Sample<Text> text = texts.take()) {
      any = true;
      if ((text->size() != 2 || text->front() != text->back()) && !given_up) ++wrong;
      ++received;
    }
    if (any && was_closed && connection == number) ++ghosts;
  }
};

Policy policy_of(unsigned number) {
  switch (number % 5) {
    case 0:
      return {BufferKind::Data, 1};
    case 4:
      return {BufferKind::Data, 1, Transport::SharedMemory, true};
    case 1:
      return {BufferKind::Buffer, 4};
    case 2:
      return {BufferKind::CircularBuffer, 3};
    default:
      return {BufferKind::Buffer, 100};
  }
}

struct Storm {
  Pair pair;
  std::pair<std::unique_ptr<Task>, Writer*> writer =
      running<Writer>("writer", {.trigger = Trigger::Periodic, .period = std::chrono::microseconds(50)});
};

/// Connects and disconnects while both sides run; half of the readers are triggered, half poll.
void storm(Storm& storm, unsigned seed, Reader& reader, int rounds) {
  std::minstd_rand random(seed);
  for (int round = 0; round < rounds; ++round) {
    ++reader.connection;
    reader.closed = false;
    const Link poses = storm.pair.connect(storm.writer.second->poses, reader.poses,
                                          policy_of(static_cast<unsigned>(random())));
    const Link texts = storm.pair.connect(storm.writer.second->texts, reader.texts,
                                          policy_of(static_cast<unsigned>(random())));
    ASSERT_TRUE(poses.ok) << to_string(poses.error);
    ASSERT_TRUE(texts.ok) << to_string(texts.error);
    const std::uint64_t before = reader.received;
    for (int spin = 0; spin < 20 && reader.received == before; ++spin)
      std::this_thread::yield();
    if (random() % 2 == 0) {
      poses.input->disconnect();
      texts.input->disconnect();
    }
    storm.pair.disconnect(poses);
    storm.pair.disconnect(texts);
    reader.closed = true;
    ASSERT_EQ(poses.input->corrupt() + poses.output->corrupt(), 0U);
    ASSERT_EQ(texts.input->corrupt() + texts.output->corrupt(), 0U);
  }
}

TEST(SharedStorm, ConnectingAtFullRateNeitherTearsNorHauntsNorLeaks) {
  Storm weather;
  const MemoryUsage idle = weather.pair.reader->usage();
  {
    std::vector<std::pair<std::unique_ptr<Task>, Reader*>> readers;
    readers.push_back(running<Reader>("driven", {}));
    readers.push_back(
        running<Reader>("periodic", {.trigger = Trigger::Periodic, .period = std::chrono::microseconds(70)}));
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < readers.size(); ++i)
      threads.emplace_back([&, i] { storm(weather, i + 1, *readers[i].second, 200); });
    for (std::thread& thread : threads)
      thread.join();
    // A last connection must still work and wake its reader.
    Reader& driven = *readers.front().second;
    driven.closed = false;
    const Link link = weather.pair.connect(weather.writer.second->poses, driven.poses, {});
    ASSERT_TRUE(link.ok);
    const std::uint64_t before = driven.received;
    EXPECT_TRUE(eventually([&] { return driven.received > before + 10; }));
    weather.pair.disconnect(link);
    for (auto& [task, reader] : readers) {
      EXPECT_TRUE(task->stop(soon()));
      EXPECT_EQ(reader->wrong, 0U);
      EXPECT_EQ(reader->unordered, 0U);
      EXPECT_EQ(reader->ghosts, 0U);
    }
  }
  EXPECT_TRUE(weather.writer.first->stop(soon()));
  weather.writer.first.reset();
  EXPECT_EQ(weather.pair.reader->usage().control_used, idle.control_used);
  EXPECT_EQ(weather.pair.writer->usage().payload_used, idle.payload_used) << "the header alone";
  EXPECT_EQ(weather.pair.writer->usage().connections, 0U);
}

TEST(SharedStorm, MemoryMayBeOfferedToSeveralAtOnce) {
  const auto memory = *SharedMemory::create();
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&memory] {
      for (int turn = 0; turn < 100; ++turn) {
        const auto offer = memory->offer();
        ASSERT_TRUE(offer) << to_string(offer.error());
        EXPECT_TRUE(PeerMemory::map(*offer));
      }
    });
  }
}

TEST(SharedStorm, EitherSideMayForgetTheOtherAtAnyTime) {
  Storm weather;
  for (int round = 0; round < 50; ++round) {
    auto [task, reader] = running<Reader>("reader", {});
    const Pair& pair = weather.pair;
    const auto again = *SharedMemory::create(kSmall);
    ASSERT_TRUE(pair.writer->admit(*again->offer()));
    ASSERT_TRUE(again->admit(*pair.writer->offer()));
    std::thread forgetter([&, reader = reader] {
      std::this_thread::yield();
      reader->given_up = true;
      pair.writer->forget(again->incarnation());
      again->forget(pair.writer->incarnation());
    });
    for (unsigned i = 0; i < 4; ++i) {
      auto input = open_input(*again, describe_output(*pair.writer, weather.writer.second->poses),
                              reader->poses, policy_of(i));
      if (!input) continue;
      static_cast<void>(
          attach_output(*pair.writer, input->place, weather.writer.second->poses, policy_of(i)));
    }
    forgetter.join();
    pair.writer->forget(again->incarnation());
    again->forget(pair.writer->incarnation());
    EXPECT_EQ(pair.writer->usage().connections, 0U);
    EXPECT_EQ(again->usage().connections, 0U);
    EXPECT_EQ(reader->wrong, 0U);
  }
}

}  // namespace
}  // namespace segue::sample_link
