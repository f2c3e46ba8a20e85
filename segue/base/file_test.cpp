// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/input_file.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace segue {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_ = fs::temp_directory_path() / ("segue_file_test." + std::to_string(::getpid()));
};

TEST_F(FileTest, ReadsBackWhatWasWritten) {
  const std::string content("a\0b\n", 4);
  ASSERT_TRUE(write_file(folder_ / "x", content));
  EXPECT_EQ(read_file(folder_ / "x").value(), content);
}

TEST_F(FileTest, ReplacesAFileAsAWholeAndLeavesNoTemporaryOne) {
  ASSERT_TRUE(write_file(folder_ / "x", "long content"));
  ASSERT_TRUE(write_file(folder_ / "x", "short"));
  EXPECT_EQ(read_file(folder_ / "x").value(), "short");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(FileTest, AnInputHasALimitThatTheEnvironmentRaises) {
  ::unsetenv(kLargestInput);
  ASSERT_TRUE(write_file(folder_ / "x", std::string((std::size_t{16} << 20) + 1, 'x')));
  const auto refused = read_input_file(folder_ / "x");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ResourceExhausted);
  EXPECT_NE(refused.error().message.find("larger than 16MiB; to read it, set the environment variable "
                                         "SEGUE_MAX_FILE_SIZE"),
            std::string::npos)
      << refused.error().message;
  ::setenv(kLargestInput, "20MB", 1);
  EXPECT_TRUE(read_input_file(folder_ / "x"));
  ::setenv(kLargestInput, "much", 1);
  const auto wrong = read_input_file(folder_ / "x");
  ::unsetenv(kLargestInput);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message.rfind("SEGUE_MAX_FILE_SIZE: ", 0), 0U) << wrong.error().message;
}

TEST_F(FileTest, SaysWhatIsMissing) {
  const auto result = read_file(folder_ / "absent");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::NotFound);
  EXPECT_NE(result.error().message.find("absent"), std::string::npos);
}

TEST_F(FileTest, RefusesAFolderAndAFileBeyondTheLimit) {
  EXPECT_EQ(read_file(folder_).error().code, ErrorCode::IoError);
  ASSERT_TRUE(write_file(folder_ / "big", std::string(100, 'x')));
  EXPECT_EQ(read_file(folder_ / "big", 99).error().code, ErrorCode::ResourceExhausted);
  EXPECT_TRUE(read_file(folder_ / "big", 100));
}

TEST_F(FileTest, AnErrorWhileReadingIsAnswered) {
  const auto memory = read_file("/proc/self/mem");  // can be opened, but nothing can be read at its begin
  ASSERT_FALSE(memory);
  EXPECT_NE(memory.error().message.find("/proc/self/mem"), std::string::npos);
}

TEST_F(FileTest, WritingIntoAMissingFolderIsAnError) {
  EXPECT_FALSE(write_file(folder_ / "no" / "x", "content"));
}

TEST_F(FileTest, WritingInPlaceOfAFolderIsAnErrorAndLeavesNoTemporaryFile) {
  fs::create_directories(folder_ / "taken" / "full");
  EXPECT_FALSE(write_file(folder_ / "taken", "content"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(FileTest, GlobFindsWhatMatchesInOrder) {
  for (const char* name : {"b.yaml", "a.yaml", "c.txt"})
    std::ofstream(folder_ / name) << "x";
  const auto found = glob_files(folder_ / "*.yaml");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].filename(), "a.yaml");
  EXPECT_EQ(found[1].filename(), "b.yaml");
  EXPECT_EQ(glob_files(folder_ / "plain").size(), 1u);
}

}  // namespace
}  // namespace segue
