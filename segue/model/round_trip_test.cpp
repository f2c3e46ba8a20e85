// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/type/json.hpp>
#include <support/random_actions.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace segue::model {
namespace {

using testing::everything;
using testing::Random;
using testing::random_transition;

RC_GTEST_PROP(RoundTripTest, NetworkFile, (std::uint64_t seed)) {
  Random random(seed);
  const Network network = testing::random_network(random, everything());
  const std::string text = write_network(network);
  Diagnostics diagnostics;
  const auto read = read_network(text, "x.yaml", diagnostics);
  if (!read || !(*read == network)) RC_LOG() << text << to_string(diagnostics);
  for (const Diagnostic& item : diagnostics.items())
    RC_ASSERT(item.code == "sections-not-read");
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == network);
}

RC_GTEST_PROP(RoundTripTest, TransitionFile, (std::uint64_t seed)) {
  Random random(seed);
  const Transition transition = random_transition(random);
  const std::string text = write_transition(transition);
  Diagnostics diagnostics;
  const auto read = read_transition(text, "x.yaml", diagnostics);
  if (!read || !(*read == transition)) RC_LOG() << text << to_string(diagnostics);
  RC_ASSERT(diagnostics.empty());
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == transition);
}

RC_GTEST_PROP(RoundTripTest, JsonOfATransition, (std::uint64_t seed)) {
  Random random(seed);
  const Transition transition = random_transition(random);
  // Numbers that JSON lacks become null, so only the frame is compared.
  const std::string text = type::to_json(to_value(transition));
  Diagnostics diagnostics;
  const auto read = read_transition(text, "x.json", diagnostics);
  if (!read) RC_LOG() << text << to_string(diagnostics);
  RC_ASSERT(diagnostics.empty());
  RC_ASSERT(read.has_value());
  RC_ASSERT(read->actions.size() == transition.actions.size());
  RC_ASSERT(read->counts().by_kind == transition.counts().by_kind);
}

}  // namespace
}  // namespace segue::model
