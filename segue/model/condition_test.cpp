// SPDX-License-Identifier: Apache-2.0
#include <segue/model/condition.hpp>

#include <gtest/gtest.h>

namespace segue::model {
namespace {

using type::Value;

bool holds_in(const std::string& text, const Value& sample) {
  const auto condition = parse_condition(text);
  EXPECT_TRUE(condition) << text;
  return condition && holds(*condition, sample);
}

TEST(Condition, ComparesFieldsWithConstants) {
  const Value sample = Value::map({{"code", 3},
                                   {"pose", Value::map({{"x", 1.5}, {"name", "dock"}})},
                                   {"ready", true},
                                   {"none", Value()}});
  for (const std::string text :
       {"code == 3", "code != 4", "code<4", "code >= 3", "pose.x <= 1.5", "pose.x > -1", "pose.name == dock",
        "ready == true", "none == null", "code == 3 and pose.x < 2 and ready != false"})
    EXPECT_TRUE(holds_in(text, sample)) << text;
  for (const std::string text : {"code == 4", "code != 3", "code < 3", "pose.x >= 1.6", "pose.name != dock",
                                 "code == 3 and ready == false"})
    EXPECT_FALSE(holds_in(text, sample)) << text;
}

TEST(Condition, ComparesTheSampleItself) {
  EXPECT_TRUE(holds_in("value < 0.2", Value(0.1)));
  EXPECT_FALSE(holds_in("value < 0.2", Value(0.3)));
  EXPECT_TRUE(holds_in("value == done", Value("done")));
  EXPECT_TRUE(holds_in("value == 'all done'", Value("all done")));
}

TEST(Condition, DoesNotHoldForWhatIsNotThereOrHasNoOrder) {
  const Value sample = Value::map({{"name", "dock"}});
  EXPECT_FALSE(holds_in("other == 1", sample));
  EXPECT_FALSE(holds_in("other != 1", sample));
  EXPECT_FALSE(holds_in("name.part == 1", sample));
  EXPECT_FALSE(holds_in("name < 1", sample));
}

TEST(Condition, MustBeAComparison) {
  for (const std::string text :
       {"", "code", "== 3", "code ==", "code = 3", "code == [1]", "a..b == 1", "code == 3 and", "a b == 1"})
    EXPECT_FALSE(parse_condition(text)) << text;
}

}  // namespace
}  // namespace segue::model
