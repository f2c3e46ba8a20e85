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

TEST(Condition, ComparesElementsOfLists) {
  const Value point = Value::map({{"x", 1.5}, {"y", Value::list({0, 7})}});
  const Value sample = Value::map({{"path", Value::list({Value::map({}), point})}});
  EXPECT_TRUE(holds_in("path[1].x == 1.5 and path[1].y[1] == 7", sample));
  EXPECT_FALSE(holds_in("path[1].y[0] == 7", sample));
  for (const std::string none :
       {"path[2].x", "path[0].x", "path[1].x[0]", "path.x", "path[99999999999999999999].x", "value[0]"})
    EXPECT_FALSE(holds_in(none + " != 0", sample)) << none;
  for (const std::string text : {"path[1].y[1]", "path[1]", "path", "value"})
    EXPECT_EQ(field_text(parse_field(text).value()), text);
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
       {"", "code", "== 3", "code ==", "code = 3", "code == [1]", "a..b == 1", "a[] == 1", "a[x] == 1",
        "a[1 == 1", "a[-1] == 1", "[1] == 1", "a[1]b == 1", "code == 3 and", "a b == 1"})
    EXPECT_FALSE(parse_condition(text)) << text;
}

}  // namespace
}  // namespace segue::model
