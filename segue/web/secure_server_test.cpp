// SPDX-License-Identifier: Apache-2.0
//
// The server for browsers of other computers: over TLS, for people with certificates.
#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/web/test_support.hpp>
#include <segue/web/web_server.hpp>

#include <support/browser.hpp>

#include <fstream>
#include <optional>
#include <vector>

namespace segue::web {
namespace {

using control::Authority;
using segue::testing::Browser;
using type::Value;

class SecureServer : public WebTest {
 protected:
  void SetUp() override {
    WebTest::SetUp();
    authority_.emplace(Authority::create(folder_ / "ca").value());
    enrolled_ = folder_ / "enrolled";
    enrol(
        {.name = "left", .host = true, .addresses = {"127.0.0.1", "left.example", "10.9.8.7", "fd00:0::7"}});
    enrol({.name = "ann", .role = control::Role::Administer});
    enrol({.name = "bob", .role = control::Role::Observe});
    std::filesystem::create_directories(folder_ / "page");
    std::ofstream(folder_ / "page" / "index.html") << "<title>the page</title>";
  }
  void TearDown() override {
    robot_.release.open();
    server_.reset();
    WebTest::TearDown();
  }
  void enrol(const control::Enrolment& enrolment) {
    const auto identity = authority_->enrol(enrolment, enrolled_);
    ASSERT_TRUE(identity) << to_string(identity.error());
  }
  Result<std::unique_ptr<Server>> try_to_start(const std::string& address, bool with_credentials,
                                               Role role = Role::Operate) {
    ServerOptions options{.listen = address, .role = role, .robot = "fake"};
    if (with_credentials) {
      options.credentials =
          control::load_credentials(enrolled_, control::CertificateUse::Host, "left").value();
    }
    return Server::start(PageFiles::read(folder_ / "page").value(), connection(), std::move(options));
  }
  void start(Role role = Role::Operate) {
    auto server = try_to_start("0.0.0.0", true, role);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  [[nodiscard]] Browser browser(const std::string& name) const {
    return Browser(server_->port(), enrolled_, name);
  }
  void revoke(const std::string& name) {
    ASSERT_TRUE(authority_->revoke(name));
    std::filesystem::copy_file(folder_ / "ca" / "ca.crl", enrolled_ / "new.crl");
    std::filesystem::rename(enrolled_ / "new.crl", enrolled_ / "ca.crl");
  }
  [[nodiscard]] std::string named(const std::string& host) const {
    return host + ":" + std::to_string(server_->port());
  }

  static constexpr const char* kSet =
      R"({"id": 1, "verb": "set", "arguments": {"task": "t", "property": "p", "value": 1}})";
  std::optional<Authority> authority_;
  std::filesystem::path enrolled_;
  std::unique_ptr<Server> server_;
};

TEST_F(SecureServer, TheRoleInTheCertificateCounts) {
  start();
  EXPECT_EQ(server_->address(), "https://" + named("left") + "/");
  Browser ann = browser("ann");
  ASSERT_TRUE(ann.enter());
  EXPECT_EQ(ann.receive(), Value::map({{"role", "operate"}, {"robot", "fake"}}));
  EXPECT_NE(ann.ask(kSet)->find("result"), nullptr);
  Browser bob = browser("bob");
  ASSERT_TRUE(bob.enter());
  EXPECT_EQ(bob.receive(), Value::map({{"role", "observe"}, {"robot", "fake"}}));
  EXPECT_EQ(*bob.ask(kSet)->find("error")->find("code"), Value("permission-denied"));
}

TEST_F(SecureServer, NobodyGetsMoreThanTheStudioPermits) {
  start(Role::Observe);
  Browser ann = browser("ann");
  ASSERT_TRUE(ann.enter());
  EXPECT_EQ(*ann.receive()->find("role"), Value("observe"));
}

TEST_F(SecureServer, ThePageIsServedUnderTheNamesOfTheHostOnly) {
  start();
  for (const std::string host :
       {"left", "127.0.0.1", "left.example", "LEFT.example", "10.9.8.7", "[fd00::7]"})
    EXPECT_EQ(browser("bob").get(named(host)), 200U) << host;
  for (const std::string host : {"evil.example", "localhost", "0.0.0.0"})
    EXPECT_EQ(browser("bob").get(named(host)), 403U) << host;
  EXPECT_EQ(browser("bob").get("left"), 403U) << "another port";
}

TEST_F(SecureServer, OtherPagesCannotUseTheCertificate) {
  start();
  for (const std::string& origin : {std::string("https://evil.example"), "http://" + named("left")})
    EXPECT_FALSE(browser("ann").enter(origin)) << origin;
}

TEST_F(SecureServer, NobodyEntersWithoutACertificateOfTheAuthority) {
  start();
  EXPECT_EQ(browser("").get(named("left")), 0U);
  enrol({.name = "eve"});
  revoke("eve");
  EXPECT_EQ(browser("eve").get(named("left")), 0U) << "revoked";
  enrol({.name = "old",
         .valid = std::chrono::hours(1),
         .from = std::chrono::system_clock::now() - std::chrono::hours(2)});
  EXPECT_EQ(browser("old").get(named("left")), 0U) << "expired";
  auto foreign = Authority::create(folder_ / "foreign").value();
  ASSERT_TRUE(foreign.enrol({.name = "mallory", .role = control::Role::Administer}, folder_ / "theirs"));
  for (const char* file : {"mallory.crt", "mallory.key"})
    std::filesystem::copy_file(folder_ / "theirs" / file, enrolled_ / file);
  EXPECT_EQ(browser("mallory").get(named("left")), 0U) << "of another authority";
  EXPECT_EQ(browser("bob").get(named("left")), 200U) << "the service goes on";
}

TEST_F(SecureServer, WhoIsRevokedIsPutOut) {
  start();
  Browser ann = browser("ann");
  ASSERT_TRUE(ann.enter());
  ASSERT_TRUE(ann.ask(kSet));
  revoke("ann");
  EXPECT_FALSE(ann.ask(kSet));
}

TEST_F(SecureServer, WhoIsRevokedAndOnlyWatchesIsPutOut) {
  start();
  Browser ann = browser("ann");
  ASSERT_TRUE(ann.enter());
  Browser bob = browser("bob");
  ASSERT_TRUE(bob.enter());
  revoke("ann");
  EXPECT_TRUE(ann.is_ended());
  EXPECT_TRUE(bob.ask(kSet)) << "others stay";
}

TEST_F(SecureServer, ConnectionsWithoutAHandshakeKeepNobodyOut) {
  start();
  boost::asio::io_context context;
  std::vector<boost::asio::ip::tcp::socket> crowd;
  while (crowd.size() < 200) {
    crowd.emplace_back(context);
    crowd.back().connect({boost::asio::ip::address_v4::loopback(), server_->port()});
  }
  EXPECT_EQ(browser("bob").get(named("left")), 200U);
}

TEST_F(SecureServer, OnePersonsConnectionsKeepNobodyElseOut) {
  start();
  std::vector<std::unique_ptr<Browser>> crowd;
  while (crowd.size() < 64) {
    crowd.push_back(std::make_unique<Browser>(server_->port(), enrolled_, "ann"));
    ASSERT_TRUE(crowd.back()->enter());
  }
  Browser bob = browser("bob");
  ASSERT_TRUE(bob.enter());
  EXPECT_TRUE(bob.ask(kSet));
  EXPECT_TRUE(crowd.front()->ask(kSet)) << "what was opened last has ended";
  EXPECT_TRUE(crowd.back()->is_ended());
}

TEST_F(SecureServer, OtherComputersNeedCertificates) {
  const auto open = try_to_start("0.0.0.0", false);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().code, ErrorCode::InvalidArgument);
  for (const std::string address : {"", "left", "300.1.1.1"})
    EXPECT_EQ(try_to_start(address, true).error().code, ErrorCode::InvalidArgument) << address;
}

}  // namespace
}  // namespace segue::web
