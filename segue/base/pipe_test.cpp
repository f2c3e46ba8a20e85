// SPDX-License-Identifier: Apache-2.0
#include <segue/base/pipe.hpp>
#include <support/eventually.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

namespace segue {
namespace {

void write_to(const Pipe& pipe, const std::string& text) {
  EXPECT_EQ(::write(pipe.write.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
}

TEST(APipe, IsReadToItsEnd) {
  auto pipe = make_pipe().value();
  const std::string part(50'000, 'x');
  std::thread writer([&] {
    for (int i = 0; i < 10; ++i)
      write_to(pipe, part);
    pipe.write = Descriptor();
  });
  const auto text = read_to_end(pipe.read, segue::testing::kPatience);
  writer.join();
  ASSERT_TRUE(text) << to_string(text.error());
  EXPECT_EQ(text->size(), 10 * part.size());
}

TEST(APipe, IsReadNoLongerThanItsReaderWaits) {
  const auto pipe = make_pipe().value();
  write_to(pipe, "some");
  EXPECT_EQ(read_to_end(pipe.read, std::chrono::milliseconds(1)).error().code, ErrorCode::DeadlineExceeded);
}

TEST(APipe, IsReadNoLongerThanItsReaderWants) {
  const auto pipe = make_pipe().value();
  std::stop_source stop;
  std::thread stopper([&] { stop.request_stop(); });
  const auto text = read_to_end(pipe.read, Wait(Deadline(segue::testing::kPatience), stop.get_token()));
  stopper.join();
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::Cancelled);
}

TEST(APipe, IsReadUpToTheMostThatIsTaken) {
  for (const auto& [text, is_taken] : {std::pair("abc", true), std::pair("abcd", false)}) {
    auto pipe = make_pipe().value();
    write_to(pipe, text);
    pipe.write = Descriptor();
    const auto read = read_to_end(pipe.read, segue::testing::kPatience, 3);
    const bool is_refused = !read && read.error().code == ErrorCode::ResourceExhausted;
    EXPECT_EQ(is_refused, !is_taken) << text;
    EXPECT_EQ(read.value_or(""), is_taken ? text : "");
  }
}

}  // namespace
}  // namespace segue
