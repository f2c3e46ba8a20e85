// SPDX-License-Identifier: Apache-2.0
#include <segue/type/value.hpp>
#include <support/random_values.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace segue::type {
namespace {

TEST(Value, KnowsItsKind) {
  EXPECT_TRUE(Value().is_null());
  EXPECT_TRUE(Value(false).is_bool());
  EXPECT_TRUE(Value("x").is_string());
  EXPECT_TRUE(Value(Value::List{}).is_list());
  EXPECT_TRUE(Value(ValueMap{}).is_map());
  EXPECT_TRUE(Value(1).is_integer() && Value(1).is_number());
  EXPECT_TRUE(Value(1.0).is_number() && !Value(1.0).is_integer());
}

TEST(Value, UnsignedNumbersAreIntWhereTheyFit) {
  constexpr auto kHighest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(Value(kHighest).kind(), Value::Kind::Int);
  EXPECT_EQ(Value(kHighest + 1).kind(), Value::Kind::UInt);
  EXPECT_EQ(Value(kHighest + 1).as_uint(), kHighest + 1);
}

TEST(Value, NumbersAreEqualByTheirNumericValue) {
  EXPECT_EQ(Value(10), Value(10.0));
  EXPECT_EQ(Value(std::nan("")), Value(std::nan("")));
  EXPECT_NE(Value(-1), Value(std::numeric_limits<std::uint64_t>::max()));
  EXPECT_NE(Value(1), Value(true));
  EXPECT_NE(Value(10), Value("10"));
}

TEST(Value, MapsAreEqualWhateverTheirOrder) {
  EXPECT_EQ(Value::map({{"a", 1}, {"b", 2}}), Value::map({{"b", 2}, {"a", 1}}));
  EXPECT_NE(Value::map({{"a", 1}, {"b", 2}}), Value::map({{"a", 1}, {"c", 2}}));
  ValueMap forward;
  ValueMap backward;
  for (int i = 0; i < 100; ++i) {
    forward.append("k" + std::to_string(i), i);
    backward.append("k" + std::to_string(99 - i), 99 - i);
  }
  EXPECT_EQ(forward, backward);
  backward["k7"] = 8;
  EXPECT_NE(forward, backward);
}

TEST(Value, MarksAndSourceTextsDoNotCountInComparison) {
  Value marked(1.1);
  marked.set_mark({3, 4});
  marked.set_source_text("1.10");
  EXPECT_EQ(marked, Value(1.1));
  const Value copy = marked;
  EXPECT_EQ(copy.mark().line, 3U);
  EXPECT_EQ(copy.source_text(), "1.10");
}

TEST(Value, CopiesAreDeep) {
  Value original = Value::map({{"a", Value::map({{"b", 1}})}});
  Value copy = original;
  copy.as_map()["a"].as_map()["b"] = 2;
  EXPECT_EQ(*original.find("a")->find("b"), Value(1));
}

TEST(Value, APartMayReplaceItsWhole) {
  Value value = Value::map({{"a", Value::map({{"b", 1}})}});
  value = *value.find("a");
  EXPECT_EQ(value, Value::map({{"b", 1}}));
}

TEST(Value, FindLooksIntoMapsOnly) {
  EXPECT_EQ(Value::map({{"a", 1}}).find("b"), nullptr);
  EXPECT_EQ(Value(1).find("a"), nullptr);
}

TEST(ValueMap, KeepsTheOrderOfWriting) {
  ValueMap map;
  map.set("z", 1);
  map.set("a", 2);
  map.set("z", 3);
  EXPECT_TRUE(map.erase("a"));
  EXPECT_FALSE(map.erase("a"));
  map["m"] = 4;
  ASSERT_EQ(map.size(), 2U);
  EXPECT_EQ(map.begin()->first, "z");
  EXPECT_EQ(map.begin()->second, Value(3));
}

TEST(Value, DescribesItselfForMessages) {
  EXPECT_EQ(describe(Value("far")), "'far'");
  EXPECT_EQ(describe(Value(30)), "30");
  EXPECT_EQ(describe(Value(1.5)), "1.5");
  EXPECT_EQ(describe(Value::list({1, 2, 3})), "a list of 3");
  EXPECT_EQ(describe(Value::map({})), "a map");
  EXPECT_EQ(describe(Value()), "nothing");
}

TEST(Merge, GoesEntryByEntryAndReplacesEverythingElse) {
  Value base = Value::map({{"range", Value::map({{"max", 1}, {"min", 0}})}, {"list", Value::list({1, 2})}});
  merge(base, Value::map({{"range", Value::map({{"max", 5}})}, {"list", Value::list({3})}, {"new", true}}));
  EXPECT_EQ(base, Value::map({{"range", Value::map({{"max", 5}, {"min", 0}})},
                              {"list", Value::list({3})},
                              {"new", true}}));
}

RC_GTEST_PROP(ValueProperties, ACopyIsEqual, ()) {
  const Value value = *random_value();
  const Value copy = value;
  RC_ASSERT(copy == value);
}

RC_GTEST_PROP(ValueProperties, EqualityIsSymmetric, ()) {
  const Value a = *random_value(2);
  const Value b = *random_value(2);
  RC_ASSERT((a == b) == (b == a));
}

RC_GTEST_PROP(ValueProperties, MergingTwiceIsMergingOnce, ()) {
  Value base = *random_value();
  const Value over = *random_value();
  merge(base, over);
  const Value once = base;
  merge(base, over);
  RC_ASSERT(base == once);
}

RC_GTEST_PROP(ValueProperties, MergingIntoNothingIsCopying, ()) {
  Value base;
  const Value over = *random_value();
  merge(base, over);
  RC_ASSERT(base == over);
}

}  // namespace
}  // namespace segue::type
