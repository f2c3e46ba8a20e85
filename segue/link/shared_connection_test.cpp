// SPDX-License-Identifier: Apache-2.0
#include <segue/link/shared_test_support.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace segue::link {
namespace {

using namespace shared_test;

TEST(SharedConnection, SamplesAreReadWhereTheWriterPutThem) {
  Pair pair;
  Source<Pose> source;
  Sink<Pose> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  for (int i = 1; i <= 3; ++i)
    EXPECT_EQ(source.out.write(Pose{i}), WriteResult::Written);
  for (int i = 1; i <= 3; ++i) {
    const auto sample = sink.in.take();
    ASSERT_TRUE(sample);
    EXPECT_EQ(*sample, Pose{i});
    EXPECT_EQ(sample.sequence(), static_cast<std::uint64_t>(i));
  }
  EXPECT_FALSE(sink.in.take());
  EXPECT_EQ(link.output->counters().read, 3U);
  EXPECT_EQ(link.input->counters().written, 3U);
}

TEST(SharedConnection, SamplesWithPointersTravelFlat) {
  Pair pair;
  Source<std::vector<std::string>> source;
  Sink<std::vector<std::string>> sink;
  Link link = pair.connect(source.out, sink.in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  const std::vector<std::string> value = {"one", "", std::string(1000, 'x')};
  source.out.write(value);
  std::vector<std::string> got;
  ASSERT_EQ(sink.in.read(got), ReadStatus::NewData);
  EXPECT_EQ(got, value);
  EXPECT_EQ(sink.in.read(got), ReadStatus::OldData);
}

TEST(SharedConnection, ReaderIsWokenByTheWriter) {
  Pair pair;
  Source<Pose> source;
  auto [task, counter] = running<Counter>("counter", {});
  Link link = pair.connect(source.out, counter->in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  for (int i = 1; i <= 1000; ++i) {
    source.out.write(Pose{i});
    ASSERT_TRUE(eventually([&, seen = counter] { return seen->last == i; })) << i;
  }
  EXPECT_TRUE(task->stop(soon()));
}

}  // namespace
}  // namespace segue::link
