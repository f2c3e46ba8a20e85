// SPDX-License-Identifier: Apache-2.0
#include "../test_network.hpp"
#include "types.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace runtime {
namespace {

using components_test::TestNetwork;
using segue::type::Value;

struct Asker : segue::task::Component {
  segue::task::OutputPort<std::string> request{*this, "request"};
};

class RequestPort : public ::testing::Test {
 protected:
  RequestPort() {
    network_.add("runtime", "runtime::Requests");
    network_.connect(asker_.request, network_.input("runtime", "request"));
    network_.start("runtime");
  }
  void write(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      asker_.request.write(name);
      network_.run_ready();
    }
  }
  /// The names that were requested after what was asked for last.
  std::vector<std::string> requests() {
    const auto answer = network_.call("runtime", "requests", Value::list({last_}));
    if (!answer) return {segue::to_string(answer.error())};
    last_ = static_cast<std::uint64_t>(answer->find("last")->as_int());
    std::vector<std::string> names;
    for (const Value& name : answer->find("controllers")->as_list())
      names.push_back(name.as_string());
    return names;
  }

  Asker asker_;
  TestNetwork network_;
  std::uint64_t last_ = 0;
};

using Names = std::vector<std::string>;

TEST_F(RequestPort, TellsEachNameOnceInItsOrder) {
  write({"explore", "drive+arm"});
  EXPECT_EQ(requests(), (Names{"explore", "drive+arm"}));
  EXPECT_EQ(requests(), Names());
  write({"hold"});
  EXPECT_EQ(requests(), Names{"hold"});
}

TEST_F(RequestPort, ANameThatIsWrittenAgainAndAgainIsOneRequest) {
  write({"explore", "explore", "explore"});
  EXPECT_EQ(requests(), Names{"explore"});
  write({"explore", "", "", "explore"});
  EXPECT_EQ(requests(), Names{"explore"}) << "after an empty one it is a new request";
}

TEST_F(RequestPort, KeepsTheNewestSixteen) {
  for (int i = 0; i < 20; ++i)
    write({"c" + std::to_string(i)});
  const auto names = requests();
  ASSERT_EQ(names.size(), 16U);
  EXPECT_EQ(names.front(), "c4");
  EXPECT_EQ(names.back(), "c19");
}

TEST_F(RequestPort, NamesThatNoControllerCanHaveAreIgnored) {
  write({std::string(1025, 'x'), "explore"});
  EXPECT_EQ(requests(), Names{"explore"});
}

TEST_F(RequestPort, WhatWasRequestedBeforeItWasConfiguredAnewIsForgotten) {
  write({"explore"});
  network_.stop("runtime");
  ASSERT_TRUE(network_.task("runtime").cleanup(TestNetwork::soon()));
  network_.start("runtime");
  EXPECT_EQ(requests(), Names());
  write({"explore"});
  EXPECT_EQ(requests(), Names{"explore"});
}

}  // namespace
}  // namespace runtime
