// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/rpc_tls/issue.hpp>
#include <support/secure_server.hpp>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace segue::control {
namespace {

using std::chrono::hours;
using Use = CertificateUse;

unsigned permissions(const std::filesystem::path& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 0777U;
}

TEST_F(SecureTest, SecretsAreOnlyForTheirOwner) {
  EXPECT_EQ(permissions(folder_ / "ca"), 0700U);
  EXPECT_EQ(permissions(folder_ / "ca" / "ca.key"), 0600U);
  EXPECT_EQ(permissions(enrolled_ / "ann.key"), 0600U);
  EXPECT_EQ(permissions(enrolled_ / "ann.crt") & 0400U, 0400U);
}

TEST_F(SecureTest, ACertificateSaysWhoMayDoWhatAndHowLong) {
  const auto ann = credentials("ann").identity();
  EXPECT_EQ(ann.name, "ann");
  EXPECT_EQ(ann.role, Role::Operate);
  EXPECT_FALSE(ann.host);
  EXPECT_EQ(ann.valid_until - ann.valid_from, hours(365 * 24));
  const auto left = credentials("left", Use::Host).identity();
  EXPECT_TRUE(left.host);
  EXPECT_EQ(left.valid_until - left.valid_from, hours(825 * 24));
}

TEST_F(SecureTest, TheCertificateOfAHostHasTheAddressesUnderWhichBrowsersReachIt) {
  enrol({.name = "base", .host = true, .addresses = {"base.example", "10.9.8.7", "FD00:0:0::7"}});
  EXPECT_EQ(credentials("base", Use::Host).identity().addresses,
            (std::vector<std::string>{"base", "base.example", "10.9.8.7", "fd00::7"}));
}

TEST_F(SecureTest, TheListNamesAllThatWasIssuedAndRevoked) {
  const auto revoked = authority_->revoke("ann").value();
  ASSERT_EQ(revoked.size(), 1U);
  const auto all = authority_->certificates().value();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].identity.name, "ann");
  EXPECT_EQ(all[0].identity.serial, revoked[0].serial);
  EXPECT_TRUE(all[0].revoked);
  EXPECT_EQ(all[1].identity.name, "left");
  EXPECT_FALSE(all[1].revoked);
  EXPECT_EQ(authority_->revoke("ann").error().code, ErrorCode::NotFound) << "it is revoked already";
  EXPECT_TRUE(authority_->revoke(all[1].identity.serial));
}

TEST_F(SecureTest, NamesAreNeverPaths) {
  for (const std::string name : {"", "../ann", "a/b", ".", "ca", "-x", "a\nb", "ann x"}) {
    EXPECT_EQ(authority_->enrol({.name = name}, enrolled_).error().code, ErrorCode::InvalidArgument) << name;
  }
  EXPECT_EQ(load_credentials(enrolled_, Use::Person, "../enrolled/ann").error().code,
            ErrorCode::InvalidArgument);
}

TEST_F(SecureTest, KeysAreNotOverwritten) {
  EXPECT_EQ(authority_->enrol({.name = "ann"}, enrolled_).error().code, ErrorCode::AlreadyExists);
  EXPECT_EQ(Authority::create(folder_ / "ca").error().code, ErrorCode::AlreadyExists);
  EXPECT_TRUE(authority_->enrol({.name = "ann", .role = Role::Observe}, enrolled_, true));
  EXPECT_EQ(credentials("ann").identity().role, Role::Observe);
}

TEST_F(SecureTest, TheOnlyCertificateForAUseNeedsNoName) {
  EXPECT_EQ(load_credentials(enrolled_, Use::Person).value().name(), "ann");
  EXPECT_EQ(load_credentials(enrolled_, Use::Host).value().name(), "left");
  enrol({.name = "bob"});
  const auto either = load_credentials(enrolled_, Use::Person);
  ASSERT_FALSE(either);
  EXPECT_NE(either.error().message.find("ann and bob"), std::string::npos) << either.error().message;
  EXPECT_EQ(load_credentials(folder_ / "ca", Use::Person).error().code, ErrorCode::NotFound);
}

/// The message with which load_credentials() refuses ann's.
std::string complaint(const std::filesystem::path& folder, ErrorCode code) {
  const auto loaded = load_credentials(folder, Use::Person, "ann");
  if (loaded) return "none";
  EXPECT_EQ(loaded.error().code, code) << to_string(loaded.error());
  return loaded.error().message;
}

TEST_F(SecureTest, CredentialsThatCannotServeAreRefusedWithTheReason) {
  namespace fs = std::filesystem;
  using ::testing::HasSubstr;
  const auto copy = [&](const std::string& name) {
    fs::copy(enrolled_, folder_ / name);
    return folder_ / name;
  };
  const auto open = copy("open");
  ::chmod((open / "ann.key").c_str(), 0644);
  EXPECT_THAT(complaint(open, ErrorCode::PermissionDenied), HasSubstr("others may read the key"));
  for (const char* file : {"ann.key", "ann.crt", "ca.crt", "ca.crl"}) {
    const auto lacking = copy(std::string("without_") + file);
    fs::remove(lacking / file);
    EXPECT_THAT(complaint(lacking, ErrorCode::NotFound), HasSubstr(file));
    std::ofstream(lacking / file) << "no PEM";
    ::chmod((lacking / file).c_str(), 0600);
    EXPECT_THAT(complaint(lacking, ErrorCode::ParseError), HasSubstr(file));
  }
  const auto mixed = copy("mixed");
  fs::copy_file(enrolled_ / "left.key", mixed / "ann.key", fs::copy_options::overwrite_existing);
  EXPECT_THAT(complaint(mixed, ErrorCode::InvalidArgument), HasSubstr("does not belong to the key"));
  auto other = Authority::create(folder_ / "other").value();
  ASSERT_TRUE(other.enrol({.name = "ann"}, folder_ / "foreign"));
  for (const char* file : {"ca.crt", "ca.crl"})
    fs::copy_file(enrolled_ / file, folder_ / "foreign" / file, fs::copy_options::overwrite_existing);
  EXPECT_THAT(complaint(folder_ / "foreign", ErrorCode::PermissionDenied), HasSubstr("another authority"));
  const auto now = std::chrono::system_clock::now();
  ASSERT_TRUE(authority_->enrol({.name = "ann", .valid = hours(1), .from = now - hours(9)}, enrolled_, true));
  EXPECT_THAT(complaint(enrolled_, ErrorCode::PermissionDenied), HasSubstr("has expired at 20"));
  ASSERT_TRUE(authority_->enrol({.name = "ann", .from = now + hours(9)}, enrolled_, true));
  EXPECT_THAT(complaint(enrolled_, ErrorCode::PermissionDenied), HasSubstr("is not valid before 20"));
}

TEST(TcpAddress, IsReadAsItIsWritten) {
  for (const std::string text : {"10.0.0.3:7000", "[::1]:7000", "[fe80::1%eth0]:1", "left.local:65535"}) {
    EXPECT_EQ(to_string(parse_tcp_address(text).value()), text);
  }
  EXPECT_EQ(parse_tcp_address("left", 7).value(), (TcpAddress{"left", 7}));
  for (const std::string text :
       {"", ":1", "left", "left:", "left:x", "left:65536", "left:-1", "left:+1", "[::1]", "[::1", "[left]:1",
        "[::1]7", "a b:1", "a/b:1", "-a:1", "::1:7000", "left:1 "}) {
    const auto refused = parse_tcp_address(text);
    ASSERT_FALSE(refused) << text;
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
  }
}

}  // namespace
}  // namespace segue::control
