// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/web/gate.hpp>
#include <segue/web/known_browsers.hpp>

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace segue::web {
namespace {

namespace fs = std::filesystem;

class KnownBrowsersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-browsers-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file() const { return folder_ / "browsers"; }

  fs::path folder_;
};

TEST_F(KnownBrowsersTest, AreKnownToTheNextStudioByDigestsInAPrivateFile) {
  KnownBrowsers first(file());
  const std::string operates = first.add(Role::Operate);
  const std::string observes = first.add(Role::Observe);
  const KnownBrowsers next(file());
  EXPECT_EQ(next.role_of(operates), Role::Operate);
  EXPECT_EQ(next.role_of(observes), Role::Observe);
  EXPECT_EQ(next.role_of(""), std::nullopt);
  const auto text = read_file(file());
  ASSERT_TRUE(text);
  EXPECT_EQ(text->find(operates), std::string::npos);
  EXPECT_EQ(fs::status(file()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const std::string digest = text->substr(text->find(' ') + 1, 64);
  EXPECT_EQ(next.role_of(digest), std::nullopt) << "who reads the file knows no cookie";
}

TEST_F(KnownBrowsersTest, AFileOfSomethingElseCountsAsEmpty) {
  const std::string digest(64, 'a');
  const std::vector<std::string> texts = {"administer " + digest,
                                          "operate",
                                          "operate " + digest.substr(1),
                                          "\x01\xff\n",
                                          "operate " + std::string(64, 'g'),
                                          std::string(1 << 20, 'x')};
  for (const std::string& text : texts) {
    ASSERT_TRUE(write_file(file(), text));
    KnownBrowsers browsers(file());
    EXPECT_EQ(browsers.role_of("a"), std::nullopt);
    const std::string secret = browsers.add(Role::Observe);
    EXPECT_EQ(KnownBrowsers(file()).role_of(secret), Role::Observe) << text.substr(0, 80);
  }
}

TEST_F(KnownBrowsersTest, WithoutAPlaceForTheFileTheyAreKnownNow) {
  KnownBrowsers browsers(folder_ / "missing" / "browsers");
  const std::string secret = browsers.add(Role::Operate);
  EXPECT_EQ(browsers.role_of(secret), Role::Operate);
}

TEST_F(KnownBrowsersTest, WhoCameToObserveOnlyObservesLater) {
  const Gate::Place place{.names = {"localhost"}, .port = 8475};
  const auto cookie_of = [&](Role role) {
    Gate gate(place, role, KnownBrowsers(file()));
    const auto admission = gate.admit({.target = "/?token=" + gate.token(), .host = "localhost:8475"});
    EXPECT_TRUE(admission);
    return admission->new_cookie.substr(0, admission->new_cookie.find(';'));
  };
  const std::string observer = cookie_of(Role::Observe);
  const std::string operating = cookie_of(Role::Operate);
  Gate later(place, Role::Operate, KnownBrowsers(file()));
  const auto role = [&](Gate& gate, const std::string& cookie) {
    const auto admission = gate.admit({.target = "/", .host = "localhost:8475", .cookies = cookie});
    return admission ? std::optional(admission->role) : std::nullopt;
  };
  EXPECT_EQ(role(later, observer), Role::Observe);
  EXPECT_EQ(role(later, operating), Role::Operate);
  Gate for_observers(place, Role::Observe, KnownBrowsers(file()));
  EXPECT_EQ(role(for_observers, operating), Role::Observe);
}

}  // namespace
}  // namespace segue::web
