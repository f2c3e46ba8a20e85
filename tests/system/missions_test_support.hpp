// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <sstream>

#include "../support/full_disk.hpp"
#include "system_test.hpp"

namespace segue::testing {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two concurrent branches, of 2 s and of 1 s + 4 s, then 3 s.
constexpr const char* kTwoHands = R"(mission: two_hands
actions:
  left: {run: {simulated: {duration: 2s}}}
  right: {run: {simulated: {duration: 1s}}}
  far: {resources: [{block: arm}], run: {simulated: {duration: 4s}}}
  both: {outcomes: [fine], run: {decide: [{outcome: fine}]}}
  clap: {run: {simulated: {duration: 3s}}}
start: hands
states:
  hands:
    kind: barrier
    outcomes: [fine]
    on: {fine: clap}
    states:
      left: {on: {success: return fine}}
      right:
        outcomes: [fine]
        on: {fine: return fine}
        start: right
        states:
          right: {on: {success: far}}
          far: {on: {success: return fine}}
      both: {kind: decider, on: {fine: return fine}}
  clap: {on: {success: return success}}
)";

class Missions : public SystemTest {
 protected:
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

constexpr const char* kEndless = R"(mission: endless
actions:
  tick: {run: {simulated: {duration: 1s}}}
  tock: {run: {simulated: {}}}
start: tick
states:
  tick: {on: {success: tock}}
  tock: {on: {success: tick}}
)";
constexpr const char* kOneHour = R"(mission: hour
actions:
  wait: {run: {simulated: {duration: 3600s}}}
start: wait
states:
  wait: {on: {success: return success}}
)";
constexpr const char* kLong = R"j({"nodes": [
  {"name": "short", "effects": ["+p()"]},
  {"name": "long", "duration_s": 3600, "preconditions": ["p()"], "effects": ["+q()"]},
  {"name": "after", "preconditions": ["q()"], "effects": []}]})j";

}  // namespace segue::testing
