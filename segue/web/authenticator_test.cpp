// SPDX-License-Identifier: Apache-2.0
#include <segue/web/authenticator.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace segue::web {
namespace {

const Authenticator::Place kPlace{.names = {"127.0.0.1", "localhost"}, .port = 8475};
constexpr const char* kHost = "127.0.0.1:8475";

/// The cookie and the key of a browser that came in.
struct Known {
  std::string cookie;
  std::string protocols;
};

Known enter(Authenticator& authenticator, const std::string& host = kHost) {
  const auto admission = authenticator.admit({.target = "/?token=" + authenticator.token(), .host = host});
  EXPECT_TRUE(admission);
  if (!admission) return {};
  return {admission->new_cookie.substr(0, admission->new_cookie.find(';')),
          "segue.studio, key." + admission->new_key};
}

Entrance socket_of(const Known& known) {
  return {.target = "/socket",
          .host = kHost,
          .origin = std::string("http://") + kHost,
          .cookies = known.cookie,
          .protocols = known.protocols,
          .is_socket = true};
}

TEST(AuthenticatorTest, ATokenOpensOnceAndGivesACookie) {
  Authenticator authenticator(kPlace, Role::Operate);
  const std::string token = authenticator.token();
  const auto first = authenticator.admit({.target = "/?token=" + token, .host = kHost});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->new_cookie.find(token), std::string::npos);
  EXPECT_FALSE(authenticator.admit({.target = "/?token=" + token, .host = kHost})) << "it is spent";
  const std::string cookie = first->new_cookie.substr(0, first->new_cookie.find(';'));
  const auto again = authenticator.admit({.target = "/", .host = kHost, .cookies = "other=1; " + cookie});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->role, Role::Operate);
  EXPECT_EQ(again->browser, first->browser);
  EXPECT_EQ(again->new_cookie, "");
  EXPECT_NE(enter(authenticator).cookie, cookie) << "the next browser has a cookie of its own";
}

TEST(AuthenticatorTest, ACookieIsForThisStudioAndEndsWithTheBrowser) {
  Authenticator authenticator(kPlace, Role::Operate);
  const auto admission = authenticator.admit({.target = "/?token=" + authenticator.token(), .host = kHost});
  ASSERT_TRUE(admission);
  const std::string& cookie = admission->new_cookie;
  EXPECT_TRUE(cookie.starts_with("segue_studio_8475=")) << cookie;
  EXPECT_EQ(cookie.substr(cookie.find(';')), "; Path=/; HttpOnly; SameSite=Strict") << "it has no date";
}

TEST(AuthenticatorTest, ACookieAloneOpensNoSocket) {
  Authenticator authenticator(kPlace, Role::Operate);
  const Known known = enter(authenticator);
  const Known other = enter(authenticator);
  EXPECT_TRUE(authenticator.admit(socket_of(known)));
  for (const std::string& protocols :
       {std::string(), std::string("segue.studio"), std::string("key."), "key." + authenticator.token(),
        other.protocols, known.protocols + "0", known.protocols + ", " + other.protocols,
        "segue.studio, key." + known.cookie.substr(known.cookie.find('=') + 1)})
    EXPECT_FALSE(authenticator.admit(socket_of({known.cookie, protocols}))) << protocols;
  EXPECT_FALSE(authenticator.admit(socket_of({"", known.protocols}))) << "a key alone";
}

TEST(AuthenticatorTest, AKeyIsShownOnceOnly) {
  Authenticator authenticator(kPlace, Role::Operate);
  const Known known = enter(authenticator);
  const auto page = authenticator.admit({.target = "/", .host = kHost, .cookies = known.cookie});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->new_key, "") << "who has got the cookie from a browser cannot ask for the key";
}

TEST(AuthenticatorTest, WhatAStudioThatHasEndedGaveOpensNothing) {
  Known known;
  {
    Authenticator before(kPlace, Role::Operate);
    known = enter(before);
  }
  Authenticator after(kPlace, Role::Operate);
  EXPECT_FALSE(after.admit(socket_of(known)));
  EXPECT_FALSE(after.admit({.target = "/", .host = kHost, .cookies = known.cookie}));
}

TEST(AuthenticatorTest, WithoutTokenAndCookieNobodyEnters) {
  Authenticator authenticator(kPlace, Role::Operate);
  enter(authenticator);
  for (const std::string cookies :
       {"", "segue_studio_8475=", "segue_studio_8475=00", "; ;;", "segue_studio_8475"})
    EXPECT_FALSE(authenticator.admit({.target = "/", .host = kHost, .cookies = cookies})) << cookies;
  EXPECT_FALSE(authenticator.admit({.target = "/?token=", .host = kHost}));
  EXPECT_FALSE(authenticator.admit({.target = "/x?token=" + authenticator.token(), .host = kHost}));
}

TEST(AuthenticatorTest, OtherNamesOfTheHostAreRefused) {
  Authenticator authenticator(kPlace, Role::Operate);
  const std::string cookie = enter(authenticator).cookie;
  for (const std::string host :
       {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8475", "127.0.0.1:8475.evil.example",
        "localhost.evil.example:8475", "0.0.0.0:8475"}) {
    EXPECT_FALSE(authenticator.admit({.target = "/", .host = host, .cookies = cookie})) << host;
    EXPECT_FALSE(authenticator.admit({.target = "/?token=" + authenticator.token(), .host = host})) << host;
  }
  EXPECT_TRUE(authenticator.admit({.target = "/", .host = "localhost:8475", .cookies = cookie}));
}

TEST(AuthenticatorTest, OtherPagesAreRefused) {
  Authenticator authenticator(kPlace, Role::Operate);
  const Known known = enter(authenticator);
  for (const bool is_socket : {false, true}) {
    for (const std::string origin : {"http://evil.example", "null", "https://127.0.0.1:8475",
                                     "http://127.0.0.1:8476", "http://localhost:8475"}) {
      Entrance entrance = socket_of(known);
      entrance.origin = origin;
      entrance.is_socket = is_socket;
      EXPECT_FALSE(authenticator.admit(entrance)) << origin;
    }
  }
  Entrance of_no_page = socket_of(known);
  of_no_page.origin = "";
  EXPECT_FALSE(authenticator.admit(of_no_page)) << "a WebSocket of no page";
  EXPECT_TRUE(authenticator.admit(socket_of(known)));
  Entrance with_token = socket_of({});
  with_token.target = "/?token=" + authenticator.token();
  EXPECT_FALSE(authenticator.admit(with_token)) << "a WebSocket with the token";
}

TEST(AuthenticatorTest, TheOldestOfManyBrowsersIsForgotten) {
  Authenticator authenticator(kPlace, Role::Observe);
  const std::string oldest = enter(authenticator).cookie;
  const std::string second = enter(authenticator).cookie;
  for (std::size_t more = 2; more < Authenticator::kMostBrowsers + 1; ++more)
    enter(authenticator);
  EXPECT_FALSE(authenticator.admit({.target = "/", .host = kHost, .cookies = oldest}));
  const auto known = authenticator.admit({.target = "/", .host = kHost, .cookies = second});
  ASSERT_TRUE(known);
  EXPECT_EQ(known->role, Role::Observe);
}

TEST(AuthenticatorTest, WhoComesInForAnotherIsToldForWhom) {
  Authenticator authenticator(kPlace, Role::Observe);
  const auto enter_once = [&] {
    return authenticator.admit({.target = "/?token=" + authenticator.token(), .host = kHost});
  };
  const auto oldest = enter_once();
  ASSERT_TRUE(oldest);
  for (std::size_t more = 1; more < Authenticator::kMostBrowsers; ++more)
    EXPECT_EQ(enter_once()->forgotten, 0U);
  EXPECT_EQ(enter_once()->forgotten, oldest->browser);
}

TEST(AuthenticatorTest, AllNamesInTheCertificateAreOfTheHost) {
  const std::vector<std::string> names = {"arm", "Arm.Example", "10.9.8.7", "fd00::7"};
  Authenticator authenticator({.scheme = "https", .names = names, .port = 8475}, Role::Operate);
  const auto is_admitted = [&](const std::string& host) {
    return authenticator.admit({.target = "/", .host = host, .certified = Role::Operate}).has_value();
  };
  for (const std::string host :
       {"arm:8475", "arm.example:8475", "ARM.EXAMPLE:8475", "10.9.8.7:8475", "[fd00::7]:8475"})
    EXPECT_TRUE(is_admitted(host)) << host;
  for (const std::string host : {"example:8475", "x.arm:8475", "arm.example.evil:8475", "arm.example:80",
                                 "fd00::7:8475", "[fd00::8]:8475", "10.9.8.8:8475", "arm"})
    EXPECT_FALSE(is_admitted(host)) << host;
}

TEST(AuthenticatorTest, ThePortThatIsUsualIsLeftOut) {
  Authenticator authenticator({.scheme = "https", .names = {"arm"}, .port = 443}, Role::Operate);
  const auto is_admitted = [&](const std::string& host, const std::string& origin) {
    return authenticator
        .admit({.target = "/socket",
                .host = host,
                .origin = origin,
                .is_socket = true,
                .certified = Role::Operate})
        .has_value();
  };
  EXPECT_TRUE(is_admitted("arm", "https://arm"));
  EXPECT_TRUE(is_admitted("arm:443", "https://arm:443"));
  EXPECT_FALSE(is_admitted("arm:80", "https://arm:80"));
  EXPECT_FALSE(is_admitted("arm", "https://evil.example"));
}

TEST(AuthenticatorTest, ACertificateOpensAndSaysWhatItsOwnerMayDo) {
  Authenticator authenticator({.scheme = "https", .names = {"arm"}, .port = 8475}, Role::Operate);
  const auto admit = [&](const std::string& host, Role certified, const std::string& origin = "") {
    return authenticator.admit({.target = "/socket",
                                .host = host,
                                .origin = origin.empty() ? "https://" + host : origin,
                                .is_socket = true,
                                .address = "10.0.0.3",
                                .certified = certified});
  };
  EXPECT_EQ(admit("arm:8475", Role::Operate)->role, Role::Operate);
  EXPECT_EQ(admit("10.0.0.3:8475", Role::Observe)->role, Role::Observe);
  EXPECT_EQ(admit("arm:8475", Role::Operate)->new_cookie, "");
  EXPECT_FALSE(admit("evil.example:8475", Role::Operate)) << "another name of the computer";
  EXPECT_FALSE(admit("localhost:8475", Role::Operate));
  EXPECT_FALSE(admit("arm:8475", Role::Operate, "https://evil.example")) << "browsers send certificates";
  EXPECT_FALSE(admit("arm:8475", Role::Operate, "http://arm:8475"));
  EXPECT_FALSE(authenticator.admit({.target = "/", .host = "arm:8475"})) << "without a certificate";
  Authenticator for_observers({.scheme = "https", .names = {"arm"}, .port = 8475}, Role::Observe);
  EXPECT_EQ(for_observers.admit({.target = "/", .host = "arm:8475", .certified = Role::Operate})->role,
            Role::Observe);
}

}  // namespace
}  // namespace segue::web
