// SPDX-License-Identifier: Apache-2.0
#include "artemis_test.hpp"
#include "network_test.hpp"

namespace segue::testing {
namespace {

using ArtemisOnNetwork = ArtemisTest<NetworkTest>;

TEST_F(ArtemisOnNetwork, MakesAllTransitionsOnTwoHosts) {
  deal_out({"a", "b"});
  make_all_transitions();
}

TEST_F(ArtemisOnNetwork, MakesAllTransitionsOnThreeHostsFarAway) {
  say("delay 5ms");
  deal_out({"a", "b", "c"});
  make_all_transitions();
}

}  // namespace
}  // namespace segue::testing
