// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/holder_inbox.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace segue::runtime::detail {
namespace {

using ::testing::ElementsAre;
using type::Value;

std::vector<std::string> taken(HolderInbox& inbox) {
  std::vector<std::string> texts;
  for (const auto& one : inbox.take())
    texts.push_back(std::to_string(one.number) + " " + one.what);
  return texts;
}

const Value kOver = Value::map({{"how", "over"}});

Value at(const Value& where) {
  return Value::map({{"at", where}});
}

TEST(HolderInbox, KeepsStepsAndTheLatestOfAllElse) {
  HolderInbox inbox;
  EXPECT_EQ(*inbox.put("pause", {}), 1U);
  EXPECT_TRUE(inbox.put("step", kOver));
  EXPECT_TRUE(inbox.put("step", kOver));
  EXPECT_TRUE(inbox.put("break", at(Value::list({"a"}))));
  EXPECT_TRUE(inbox.put("break", at(Value::list({}))));
  EXPECT_TRUE(inbox.put("values", Value::map({{"of", ""}})));
  EXPECT_TRUE(inbox.put("go_on_at", at("a/b")));
  EXPECT_TRUE(inbox.put("resume", {}));
  EXPECT_THAT(taken(inbox), ElementsAre("2 step", "3 step", "5 break", "6 values", "7 go_on_at", "8 resume"));
  EXPECT_THAT(taken(inbox), ElementsAre());
  EXPECT_EQ(*inbox.put("stop", {}), 9U) << "numbers go on";
}

TEST(HolderInbox, RefusesWhatNobodyCanBeAskedFor) {
  HolderInbox inbox;
  const std::string too_long(2000, 'a');
  const Value::List too_many(HolderInbox::kMostBreakpoints + 1, Value("a"));
  const std::vector<std::pair<std::string, Value>> wrong = {{"dance", {}},
                                                            {"plan", {}},
                                                            {"step", {}},
                                                            {"step", Value::map({{"how", "sideways"}})},
                                                            {"step", Value::map({{"how", 3}})},
                                                            {"step", Value::list({"over"})},
                                                            {"break", at("a")},
                                                            {"break", at(Value::list({1}))},
                                                            {"break", at(Value(too_many))},
                                                            {"go_on_at", Value::map({})},
                                                            {"go_on_at", at(too_long)},
                                                            {"values", at("a")}};
  for (const auto& [what, arguments] : wrong) {
    const auto refused = inbox.put(what, arguments);
    ASSERT_FALSE(refused) << what;
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument) << what;
  }
  EXPECT_THAT(taken(inbox), ElementsAre());
}

TEST(HolderInbox, DoesNotGrowWhereNobodyListens) {
  HolderInbox inbox;
  for (std::size_t i = 0; i < HolderInbox::kMostWaiting; ++i)
    EXPECT_TRUE(inbox.put("step", kOver));
  EXPECT_EQ(inbox.put("step", kOver).error().code, ErrorCode::ResourceExhausted);
  EXPECT_EQ(taken(inbox).size(), HolderInbox::kMostWaiting);
  EXPECT_TRUE(inbox.put("step", kOver));
}

TEST(HolderInbox, KeepsOnlyWhatIsAskedFor) {
  HolderInbox inbox;
  EXPECT_TRUE(inbox.put("step", Value::map({{"how", "into"}, {"more", std::string(100'000, 'x')}})));
  EXPECT_TRUE(inbox.put("pause", Value::map({{"more", 1}})));
  const auto asked = inbox.take();
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[0].arguments, Value::map({{"how", "into"}}));
  EXPECT_TRUE(asked[1].arguments.is_null());
}

}  // namespace
}  // namespace segue::runtime::detail
