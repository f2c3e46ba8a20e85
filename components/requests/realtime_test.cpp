// SPDX-License-Identifier: Apache-2.0
//
// The updates of the request port allocate nothing.
#include "../test_network.hpp"

#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

#include <string>

namespace runtime {
namespace {

struct Asker : segue::task::Component {
  segue::task::OutputPort<std::string> request{*this, "request"};
};

TEST(RequestsRealtime, UpdatesDoNotAllocate) {
  Asker asker;
  components_test::TestNetwork network;
  network.add("runtime", "runtime::Requests");
  network.connect(asker.request, network.input("runtime", "request"));
  network.start("runtime");
  asker.request.prime(std::string(1100, 'x'));
  std::string name;
  name.reserve(1100);
  for (int i = 0; i < 40; ++i) {
    name.assign(static_cast<std::size_t>(1000 + i), 'x');  // the last ones are too long
    segue::testing::trapped = true;
    asker.request.write(name);
    network.run_ready();
    segue::testing::trapped = false;
  }
  EXPECT_EQ(segue::testing::caught, 0);
}

}  // namespace
}  // namespace runtime
