// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/files.hpp>

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace segue::testing {

/// The network that a text says; an empty one, and a failure of the test, where the text is not valid.
inline model::Network network_of(std::string_view text, const std::string& file = "test.yaml") {
  Diagnostics diagnostics;
  auto network = model::read_network(text, file, diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  return network.value_or(model::Network{});
}

}  // namespace segue::testing
