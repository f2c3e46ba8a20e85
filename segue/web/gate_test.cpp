// SPDX-License-Identifier: Apache-2.0
#include <segue/web/gate.hpp>

#include <gtest/gtest.h>

namespace segue::web {
namespace {

const Gate::Place kPlace{.names = {"127.0.0.1", "localhost"}, .port = 8475};
constexpr const char* kHost = "127.0.0.1:8475";

std::string enter(Gate& gate) {
  const auto admission = gate.admit({.target = "/?token=" + gate.token(), .host = kHost});
  EXPECT_TRUE(admission);
  const std::string cookie = admission ? admission->new_cookie : "";
  return cookie.substr(0, cookie.find(';'));
}

TEST(GateTest, ATokenOpensOnceAndGivesACookie) {
  Gate gate(kPlace, Role::Operate);
  const std::string token = gate.token();
  const auto first = gate.admit({.target = "/?token=" + token, .host = kHost});
  ASSERT_TRUE(first);
  EXPECT_NE(first->new_cookie.find("; HttpOnly; SameSite=Strict"), std::string::npos) << first->new_cookie;
  EXPECT_EQ(first->new_cookie.find(token), std::string::npos);
  EXPECT_FALSE(gate.admit({.target = "/?token=" + token, .host = kHost})) << "it is spent";
  const std::string cookie = first->new_cookie.substr(0, first->new_cookie.find(';'));
  const auto again = gate.admit({.target = "/", .host = kHost, .cookies = "other=1; " + cookie});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->role, Role::Operate);
  EXPECT_EQ(again->new_cookie, "");
  EXPECT_NE(enter(gate), cookie) << "the next browser has a cookie of its own";
}

TEST(GateTest, WithoutTokenAndCookieNobodyEnters) {
  Gate gate(kPlace, Role::Operate);
  enter(gate);
  for (const std::string cookies :
       {"", "segue_studio_8475=", "segue_studio_8475=00", "; ;;", "segue_studio_8475"})
    EXPECT_FALSE(gate.admit({.target = "/", .host = kHost, .cookies = cookies})) << cookies;
  EXPECT_FALSE(gate.admit({.target = "/?token=", .host = kHost}));
  EXPECT_FALSE(gate.admit({.target = "/x?token=" + gate.token(), .host = kHost}));
}

TEST(GateTest, OtherNamesOfTheHostAreRefused) {
  Gate gate(kPlace, Role::Operate);
  const std::string cookie = enter(gate);
  for (const std::string host :
       {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8475", "127.0.0.1:8475.evil.example",
        "localhost.evil.example:8475", "0.0.0.0:8475"}) {
    EXPECT_FALSE(gate.admit({.target = "/", .host = host, .cookies = cookie})) << host;
    EXPECT_FALSE(gate.admit({.target = "/?token=" + gate.token(), .host = host})) << host;
  }
  EXPECT_TRUE(gate.admit({.target = "/", .host = "localhost:8475", .cookies = cookie}));
}

TEST(GateTest, OtherPagesAreRefused) {
  Gate gate(kPlace, Role::Operate);
  const std::string cookie = enter(gate);
  for (const bool socket : {false, true}) {
    for (const std::string origin : {"http://evil.example", "null", "https://127.0.0.1:8475",
                                     "http://127.0.0.1:8476", "http://localhost:8475"})
      EXPECT_FALSE(gate.admit(
          {.target = "/", .host = kHost, .origin = origin, .cookies = cookie, .is_socket = socket}))
          << origin;
  }
  EXPECT_FALSE(gate.admit({.target = "/socket", .host = kHost, .cookies = cookie, .is_socket = true}))
      << "a WebSocket of no page";
  EXPECT_TRUE(gate.admit({.target = "/socket",
                          .host = kHost,
                          .origin = std::string("http://") + kHost,
                          .cookies = cookie,
                          .is_socket = true}));
  EXPECT_FALSE(gate.admit({.target = "/?token=" + gate.token(),
                           .host = kHost,
                           .origin = std::string("http://") + kHost,
                           .is_socket = true}))
      << "a WebSocket with the token";
}

TEST(GateTest, TheOldestOfManyBrowsersIsForgotten) {
  Gate gate(kPlace, Role::Observe);
  const std::string oldest = enter(gate);
  const std::string second = enter(gate);
  for (std::size_t more = 2; more < KnownBrowsers::kMost + 1; ++more)
    enter(gate);
  EXPECT_FALSE(gate.admit({.target = "/", .host = kHost, .cookies = oldest}));
  const auto known = gate.admit({.target = "/", .host = kHost, .cookies = second});
  ASSERT_TRUE(known);
  EXPECT_EQ(known->role, Role::Observe);
}

TEST(GateTest, ACertificateOpensAndSaysWhatItsOwnerMayDo) {
  Gate gate({.scheme = "https", .names = {"arm"}, .port = 8475}, Role::Operate);
  const auto admit = [&](const std::string& host, Role certified, const std::string& origin = "") {
    return gate.admit({.target = "/socket",
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
  EXPECT_FALSE(gate.admit({.target = "/", .host = "arm:8475"})) << "without a certificate";
  Gate for_observers({.scheme = "https", .names = {"arm"}, .port = 8475}, Role::Observe);
  EXPECT_EQ(for_observers.admit({.target = "/", .host = "arm:8475", .certified = Role::Operate})->role,
            Role::Observe);
}

}  // namespace
}  // namespace segue::web
