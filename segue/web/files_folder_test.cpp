// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/web/files_folder.hpp>

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <string>

namespace segue::web {
namespace {

namespace fs = std::filesystem;

class FileFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-folder-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    root_ = pattern;
    fs::create_directories(root_ / "robot" / "networks");
    ASSERT_TRUE(write_file(root_ / "robot" / "networks" / "a.yaml", "network: a\n"));
    ASSERT_TRUE(write_file(root_ / "secret", "a secret"));
    auto folder = FileFolder::open(root_ / "robot");
    ASSERT_TRUE(folder);
    folder_.emplace(std::move(*folder));
  }
  void TearDown() override { fs::remove_all(root_); }

  [[nodiscard]] ErrorCode refusal(std::string_view path) const {
    const auto content = folder_->read(path);
    const auto found = folder_->stat(path);
    const auto saved = folder_->replace(path, "x", "");
    if (content || found || saved) return ErrorCode::Internal;  // ADD_FAILURE() would not say which path
    EXPECT_EQ(content.error().code, found.error().code) << path;
    return content.error().code;
  }

  fs::path root_;
  std::optional<FileFolder> folder_;
};

TEST_F(FileFolderTest, ReadsAndReplacesKeepingTheMode) {
  const fs::path file = root_ / "robot" / "networks" / "a.yaml";
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  const auto before = folder_->read("networks/a.yaml");
  ASSERT_TRUE(before);
  EXPECT_EQ(before->text, "network: a\n");
  const auto version = folder_->replace("networks/a.yaml", "network: b\n", before->version);
  ASSERT_TRUE(version) << to_string(version.error());
  const auto after = folder_->read("networks/a.yaml");
  ASSERT_TRUE(after);
  EXPECT_EQ(after->text, "network: b\n");
  EXPECT_EQ(after->version, *version);
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
}

TEST_F(FileFolderTest, WhatChangedMeanwhileIsNotOverwritten) {
  const fs::path file = root_ / "robot" / "networks" / "a.yaml";
  const auto before = folder_->read("networks/a.yaml");
  ASSERT_TRUE(before);
  ASSERT_TRUE(write_file(file, "network: theirs\n"));
  const auto refused = folder_->replace("networks/a.yaml", "network: mine\n", before->version);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidState);
  EXPECT_EQ(read_file(file).value(), "network: theirs\n");
  fs::remove(file);
  const auto gone = folder_->replace("networks/a.yaml", "network: mine\n", before->version);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::InvalidState);
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(FileFolderTest, NoPathLeadsOut) {
  const std::string secret = (root_ / "secret").string();
  for (const std::string& path :
       {std::string("../secret"), std::string("networks/../../secret"), std::string("./networks/a.yaml"),
        std::string("networks//a.yaml"), std::string("networks/"), std::string(), std::string("/"), secret,
        std::string("networks/a.yaml\0", 16), std::string(5000, 'a'), std::string("..")})
    EXPECT_EQ(refusal(path), ErrorCode::InvalidArgument) << path;
  EXPECT_EQ(refusal("networks"), ErrorCode::PermissionDenied);
  EXPECT_EQ(folder_->read("networks\\..\\a.yaml").error().code, ErrorCode::NotFound);
  EXPECT_EQ(read_file(root_ / "secret").value(), "a secret");
}

TEST_F(FileFolderTest, LinksAndDevicesAreRefused) {
  fs::create_symlink(root_ / "secret", root_ / "robot" / "link.yaml");
  fs::create_symlink("networks/a.yaml", root_ / "robot" / "inner.yaml");
  fs::create_directory_symlink(root_, root_ / "robot" / "up");
  ASSERT_EQ(::mkfifo((root_ / "robot" / "pipe.yaml").c_str(), 0600), 0);
  for (const std::string path : {"link.yaml", "inner.yaml", "up/secret", "pipe.yaml"})
    EXPECT_EQ(refusal(path), ErrorCode::PermissionDenied) << path;
  EXPECT_EQ(read_file(root_ / "secret").value(), "a secret");
}

TEST_F(FileFolderTest, WhatIsTooLargeIsRefused) {
  const std::string large(FileFolder::kLongestFile + 1, '#');
  const auto before = folder_->read("networks/a.yaml");
  ASSERT_TRUE(before);
  EXPECT_EQ(folder_->replace("networks/a.yaml", large, before->version).error().code,
            ErrorCode::ResourceExhausted);
  ASSERT_TRUE(write_file(root_ / "robot" / "large.yaml", large));
  EXPECT_EQ(folder_->read("large.yaml").error().code, ErrorCode::ResourceExhausted);
}

}  // namespace
}  // namespace segue::web
