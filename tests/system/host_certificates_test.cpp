// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc/credentials.hpp>
#include <segue/rpc_tls/credential_files.hpp>

#include <sys/stat.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using control::Credentials;
using type::Value;

class HostCertificates : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);
    own_ = folder_ / "config" / "segue" / "credentials";
  }
  void TearDown() override {
    ::unsetenv("XDG_CONFIG_HOME");
    SystemTest::TearDown();
  }

  std::string field(const Value& value, const char* key) {
    const Value* found = value.find(key);
    return found != nullptr && found->is_string() ? found->as_string() : std::string();
  }

  std::filesystem::path own_;
};

TEST_F(HostCertificates, AnAuthorityBeginsWithItsUserAndHost) {
  const auto made = json({"host", "init", "--host", "left"});
  EXPECT_EQ(field(made, "folder"), own_.string());
  ASSERT_EQ(made.find("certificates")->as_list().size(), 2U);
  const auto user = control::load_credentials(own_, control::CertificateUse::Person);
  ASSERT_TRUE(user) << to_string(user.error());
  EXPECT_EQ(user->identity().role, control::Role::Administer);
  const auto host = control::load_credentials(own_, control::CertificateUse::Host);
  ASSERT_TRUE(host) << to_string(host.error());
  EXPECT_EQ(host->name(), "left");
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "config" / "segue" / "ca" / "ca.key").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST_F(HostCertificates, NoKeyIsReplacedUnlessAsked) {
  ASSERT_EQ(segue({"host", "init", "--host", "left"}).status, 0);
  const auto again = segue({"host", "init", "--host", "left"});
  EXPECT_EQ(again.status, 1);
  EXPECT_NE(again.errors.find("--force replaces it"), std::string::npos) << again.errors;
  EXPECT_EQ(segue({"host", "init", "--host", "left", "--force"}).status, 0);
  ASSERT_EQ(segue({"host", "enrol", "ann"}).status, 0);
  EXPECT_EQ(segue({"host", "enrol", "ann"}).status, 1);
  EXPECT_EQ(segue({"host", "enrol", "ann", "--force"}).status, 0);
}

TEST_F(HostCertificates, EnrolledComputersGetAFolderThatServes) {
  ASSERT_EQ(segue({"host", "init", "--no-host"}).status, 0);
  const auto enrolled = segue({"host", "enrol", "right", "--host", "--role", "administer", "--days", "10"});
  EXPECT_EQ(enrolled.status, 0) << enrolled.errors;
  EXPECT_NE(enrolled.output.find("scp -r right/."), std::string::npos) << enrolled.output;
  const auto right = control::load_credentials(folder_ / "right", control::CertificateUse::Host);
  ASSERT_TRUE(right) << to_string(right.error());
  EXPECT_EQ(right->identity().role, control::Role::Administer);
  EXPECT_EQ(right->identity().valid_until - right->identity().valid_from, std::chrono::hours(240));
  EXPECT_EQ(segue({"host", "enrol", "../right"}).status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.parent_path() / "right"));
}

TEST_F(HostCertificates, WhatIsRevokedStandsInTheListAndInTheUsersOwnCopy) {
  ASSERT_EQ(segue({"host", "init", "--no-host"}).status, 0);
  ASSERT_EQ(segue({"host", "enrol", "ann", "--role", "operate"}).status, 0);
  const auto before = std::filesystem::file_size(own_ / "ca.crl");
  const auto revoked = json({"host", "revoke", "ann"});
  ASSERT_EQ(revoked.find("revoked")->as_list().size(), 1U);
  EXPECT_GT(std::filesystem::file_size(own_ / "ca.crl"), before);
  const auto all = json({"host", "certificates"});
  ASSERT_EQ(all.as_list().size(), 2U);
  for (const Value& one : all.as_list())
    EXPECT_EQ(one.find("revoked")->is_string(), field(one, "name") == "ann");
  EXPECT_NE(segue({"host", "certificates"}).output.find("ann   operate"), std::string::npos);
  const auto twice = segue({"host", "revoke", "ann"});
  EXPECT_EQ(twice.status, 1);
  EXPECT_NE(twice.errors.find("revoked already"), std::string::npos) << twice.errors;
}

TEST_F(HostCertificates, WithoutAnAuthorityTheWayToOneIsShown) {
  for (const auto& verb : {std::vector<std::string>{"host", "enrol", "ann"},
                           {"host", "revoke", "ann"},
                           {"host", "certificates"}}) {
    const auto refused = segue(verb);
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.errors.find("make one with `segue host init`"), std::string::npos) << refused.errors;
  }
  EXPECT_EQ(segue({"host", "enrol", "ann", "--role", "king"}).status, 2);
  EXPECT_EQ(segue({"host", "enrol", "ann", "--days", "0"}).status, 2);
}

}  // namespace
}  // namespace segue::testing
