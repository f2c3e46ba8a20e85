// SPDX-License-Identifier: Apache-2.0
#include "artemis_test.hpp"

namespace segue::testing {
namespace {

using Artemis = ArtemisTest<HostsTest>;

TEST_F(Artemis, MakesAllTransitionsOnTwoHosts) {
  deal_out({"a", "b"});
  make_all_transitions();
}

TEST_F(Artemis, MakesAllTransitionsOnThreeHosts) {
  deal_out({"a", "b", "c"});
  make_all_transitions();
}

}  // namespace
}  // namespace segue::testing
