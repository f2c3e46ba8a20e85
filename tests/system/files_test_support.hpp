// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/paths.hpp>

#include <sstream>

#include "system_test.hpp"

namespace segue::testing {

using ::testing::Test;
using type::Value;

constexpr auto kOne = R"(network: one
tasks:
  a: {component: "demo::Drive"}
  b: {component: "demo::Odometry"}
connections: [a.velocity -> b.velocity]
)";
constexpr auto kTwo = R"(network: two
tasks:
  a: {component: "demo::Drive"}
)";

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Files : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("one.yaml", kOne);
    write("two.yaml", kTwo);
  }
};

}  // namespace segue::testing
