// SPDX-License-Identifier: Apache-2.0
#include <segue/web/change.hpp>

#include <gtest/gtest.h>

namespace segue::web {
namespace {

using type::Value;

/// The value after a page has applied the change.
Value changed(Value value, const Value& change) {
  if (const Value* removed = change.find("remove")) {
    for (const Value& key : removed->as_list())
      EXPECT_TRUE(value.as_map().erase(key.as_string()));
  }
  if (const Value* set = change.find("set")) {
    for (const auto& [key, entry] : set->as_map())
      value.as_map().set(key, entry);
  }
  if (const Value* inner = change.find("in")) {
    for (const auto& [key, entry] : inner->as_map())
      value.as_map().set(key, changed(*value.find(key), entry));
  }
  return value;
}

Value state(int number) {
  type::ValueMap map;
  for (int bit = 0; bit < 4; ++bit) {
    const int digit = number / (bit == 0 ? 1 : bit == 1 ? 4 : bit == 2 ? 16 : 64) % 4;
    const std::string key(1, static_cast<char>('a' + bit));
    if (digit == 1) map.set(key, Value());
    if (digit == 2) map.set(key, digit + bit);
    if (digit == 3) map.set(key, Value::map({{"x", number % 3}, {"y", Value::map({{"z", number % 5}})}}));
  }
  return map;
}

TEST(Change, TurnsEachMapIntoEachOther) {
  for (int from = 0; from < 256; from += 3) {
    for (int to = 0; to < 256; ++to) {
      const Value change = change_between(state(from), state(to));
      EXPECT_EQ(changed(state(from), change), state(to));
      EXPECT_EQ(change.as_map().empty(), state(from) == state(to));
    }
  }
}

TEST(Change, NamesOnlyWhatDiffers) {
  const Value from =
      Value::map({{"tasks", Value::map({{"a", Value::map({{"n", 1}, {"s", "x"}})}})}, {"same", 1}});
  const Value to =
      Value::map({{"tasks", Value::map({{"a", Value::map({{"n", 2}, {"s", "x"}})}})}, {"same", 1}});
  EXPECT_EQ(
      change_between(from, to),
      Value::map(
          {{"in",
            Value::map(
                {{"tasks",
                  Value::map(
                      {{"in", Value::map({{"a", Value::map({{"set", Value::map({{"n", 2}})}})}})}})}})}}));
}

TEST(Keyed, ListsBecomeMapsAndOddItemsAreLeftOut) {
  const Value a = Value::map({{"from", "p"}, {"to", "q"}});
  EXPECT_EQ(keyed({a, Value(3), a, Value::map({{"from", 1}})}, {"from", "to"}), Value::map({{"p q", a}}));
}

}  // namespace
}  // namespace segue::web
