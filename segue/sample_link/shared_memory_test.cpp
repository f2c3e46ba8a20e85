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

TEST(SharedConnection, ForgettingAPeerGivesBackWhatItHolds) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::CircularBuffer, 3});
  ASSERT_TRUE(link.ok);
  for (int i = 0; i < 10; ++i)
    source.out.write(Pose(i));
  const auto held = sink.in.take();
  pair.writer->forget(pair.reader->incarnation());
  EXPECT_FALSE(link.output->connected());
  EXPECT_FALSE(pair.writer->knows(pair.reader->incarnation()));
  Sink<Pose> local;
  ASSERT_TRUE(connect(source.out, local.in, {BufferKind::Buffer, 3}));
  std::vector<Sample<Pose>> taken;
  while (source.out.write(Pose(1)) != WriteResult::NoSlot && taken.size() < 100)
    taken.push_back(local.in.take());
  EXPECT_GE(taken.size(), 7U) << "every slot came back";
  pair.reader->forget(pair.writer->incarnation());
  EXPECT_FALSE(link.input->connected());
  EXPECT_EQ(pair.reader->usage().peers, 0U);
  EXPECT_TRUE(held->whole()) << "the map stays as long as a sample of it is held";
}

TEST(SharedConnection, FullPoolRefusesAndNeverAborts) {
  Pair pair({std::size_t{1} << 16, std::size_t{1} << 18, std::size_t{1} << 20});
  Source<Text> source;
  Sink<Text> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 100});
  ASSERT_TRUE(link.ok);
  const Text large = {std::string(60'000, 'x')};
  int taken = 0;
  while (source.out.write(large) == WriteResult::Written)
    ++taken;
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 4);
  EXPECT_EQ(link.output->counters().dropped, 1U);
  for (int i = 0; i < taken; ++i)
    EXPECT_TRUE(sink.in.take());
  EXPECT_EQ(source.out.write(large), WriteResult::Written) << "room came back";

  Source<Pose> poses;
  Sink<Pose> pose_sink;
  const Link refused = pair.connect(poses.out, pose_sink.in, {BufferKind::Buffer, 5000});
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.error.code, ErrorCode::ResourceExhausted);
  EXPECT_EQ(poses.out.write(Pose(1)), WriteResult::NotConnected);
}

TEST(SharedConnection, ReaderThatKeepsAllStarvesOnlyItself) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> greedy;
  Sink<Pose> modest("modest");
  ASSERT_TRUE(pair.connect(source.out, greedy.in, {}).ok);
  ASSERT_TRUE(pair.connect(source.out, modest.in, {}).ok);
  std::vector<Sample<Pose>> kept;
  for (int i = 1; i < 30; ++i) {
    EXPECT_NE(source.out.write(Pose(i)), WriteResult::NoSlot);
    if (auto sample = greedy.in.take()) kept.push_back(sample);
    EXPECT_EQ(*modest.in.take(), Pose(i));
  }
  for (std::size_t i = 0; i < kept.size(); ++i)
    EXPECT_EQ(*kept[i], Pose(static_cast<int>(i) + 1));
}

TEST(SharedConnection, PortsOfOneTopicAreRefused) {
  Pair pair;
  Component writer;
  Component reader;
  const type::TypeInfo& type = type::type_info<Pose>();
  task::OutputPortBase out(writer, "out", &type, "", task::PortOptions{.topic = "topic /a"});
  task::InputPortBase in(reader, "in", &type, "", task::PortOptions{.topic = "topic /a"});
  task::InputPortBase other(reader, "other", &type, "", task::PortOptions{.topic = "topic /b"});
  const Link refused = pair.connect(out, in, {});
  EXPECT_EQ(refused.error.code, ErrorCode::AlreadyExists);
  EXPECT_NE(refused.error.message.find("out and in are both topic /a"), std::string::npos);
  EXPECT_TRUE(pair.connect(out, other, {}).ok);
}

TEST(SharedConnection, DuplicatesAndWrongTypesAreRefused) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Sink<Text> text;
  ASSERT_TRUE(pair.connect(source.out, sink.in, {}).ok);
  EXPECT_EQ(pair.connect(source.out, sink.in, {}).error.code, ErrorCode::AlreadyExists);
  EXPECT_TRUE(pair.connect(source.out, sink.in, {BufferKind::Buffer, 2}).ok);
  const Link wrong = pair.connect(source.out, text.in, {});
  EXPECT_EQ(wrong.error.code, ErrorCode::TypeMismatch);
  EXPECT_NE(wrong.error.message.find("Pose"), std::string::npos);
  EXPECT_NE(wrong.error.message.find("string"), std::string::npos);
  EXPECT_EQ(pair.connect(source.out, sink.in, {BufferKind::Buffer, 0}).error.code,
            ErrorCode::InvalidArgument);
  EXPECT_EQ(pair.connect(source.out, sink.in, {BufferKind::Data, 1, Transport::Dds}).error.code,
            ErrorCode::Unsupported);
}

TEST(SharedConnection, LargeSamplesTakeOnlyTheMemoryThatIsWritten) {
  Pair pair({std::size_t{1} << 16, std::size_t{1} << 32, std::size_t{1} << 20});
  Source<Image> source;
  Sink<Image> sink;
  ASSERT_TRUE(pair.connect(source.out, sink.in, {}).ok);
  for (std::uint8_t i = 1; i < 20; ++i) {
    auto loan = source.out.loan();
    ASSERT_TRUE(loan);
    loan->pixels.front() = i;
    loan->pixels.back() = i;
    loan.publish();
    const auto sample = sink.in.take();
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->pixels.front(), i);
    EXPECT_EQ(sample->pixels.back(), i);
  }
}

TEST(SharedMemory, OfferThatIsNoneIsRefused) {
  const auto memory = *SharedMemory::create(kSmall);
  const auto other = *SharedMemory::create(kSmall);
  const auto refused = [&](MemoryOffer offer) {
    const auto admitted = memory->admit(offer);
    return !admitted && admitted.error().code == ErrorCode::InvalidArgument;
  };
  const auto plain_file = [] {
    Descriptor file(memfd_create("plain", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    EXPECT_EQ(ftruncate(file.get(), 1 << 20), 0);
    return file;
  };
  EXPECT_TRUE(refused({0, Descriptor(), Descriptor()}));
  EXPECT_TRUE(refused({7, Descriptor(), Descriptor()}));
  EXPECT_TRUE(refused({other->incarnation(), plain_file(), std::move(other->offer()->control)}));
  EXPECT_TRUE(refused({other->incarnation(), std::move(other->offer()->payload), plain_file()}));
  EXPECT_TRUE(refused(
      {other->incarnation() + 1, std::move(other->offer()->payload), std::move(other->offer()->control)}))
      << "another process's";
  EXPECT_TRUE(
      refused({other->incarnation(), std::move(other->offer()->control), std::move(other->offer()->control)}))
      << "which could still be mapped for writing";
  Descriptor pipe_end(eventfd(0, EFD_CLOEXEC));
  EXPECT_TRUE(refused({other->incarnation(), std::move(pipe_end), std::move(other->offer()->control)}));
  EXPECT_EQ(memory->usage().peers, 0U);
  EXPECT_TRUE(memory->admit(*other->offer()));
  EXPECT_TRUE(memory->admit(*other->offer())) << "again";
  EXPECT_EQ(memory->usage().peers, 1U);
}

TEST(SharedMemory, NobodyElseCanWriteToThePayloads) {
  const auto memory = *SharedMemory::create(kSmall);
  const auto offer = memory->offer();
  ASSERT_TRUE(offer);
  const std::byte byte{1};
  EXPECT_LT(pwrite(offer->payload.get(), &byte, 1, 0), 0);
  EXPECT_EQ(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, offer->payload.get(), 0), MAP_FAILED);
  EXPECT_LT(ftruncate(offer->payload.get(), 0), 0);
  EXPECT_LT(ftruncate(offer->control.get(), 0), 0);
}

TEST(SharedMemory, SizesThatCannotBeAreRefused) {
  EXPECT_FALSE(SharedMemory::create({0, 0, 1 << 20}));
  EXPECT_FALSE(SharedMemory::create({0, 1 << 20, 4096}));
  EXPECT_FALSE(SharedMemory::create({1 << 21, 1 << 20, 1 << 20}));
  EXPECT_FALSE(SharedMemory::create({0, std::size_t{1} << 50, 1 << 20}));
}

}  // namespace
}  // namespace segue::sample_link
