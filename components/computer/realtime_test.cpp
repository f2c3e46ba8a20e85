// SPDX-License-Identifier: Apache-2.0
//
// The updates of the monitor allocate nothing.
#include "../test_network.hpp"
#include "types.hpp"

#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

#include <chrono>

namespace computer {
namespace {

using namespace std::chrono_literals;

struct Reader : segue::task::Component {
  segue::task::InputPort<Load> load{*this, "load"};
};

TEST(ComputerRealtime, UpdatesDoNotAllocate) {
  Reader reader;
  components_test::TestNetwork network;
  network.add("monitor", "computer::Monitor");
  network.connect(network.output("monitor", "load"), reader.load);
  network.start("monitor");
  Load load;
  for (int i = 0; i < 20; ++i) {
    segue::testing::trapped = true;
    network.advance(500ms);
    segue::testing::trapped = false;
    EXPECT_EQ(reader.load.read(load), segue::task::ReadStatus::NewData);
  }
  EXPECT_EQ(segue::testing::caught, 0);
}

}  // namespace
}  // namespace computer
