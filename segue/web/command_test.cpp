// SPDX-License-Identifier: Apache-2.0
#include <segue/web/command.hpp>

#include <gtest/gtest.h>

namespace segue::web {
namespace {

TEST(CommandText, IsTaken) {
  const auto command = Command::parse(
      R"({"id": 4, "verb": "set", "arguments": {"task": "t", "yaml": "{x: 1}", "timeout_s": 2.5}})");
  ASSERT_TRUE(command) << to_string(command.error());
  EXPECT_EQ(command->id(), 4U);
  EXPECT_EQ(command->verb(), "set");
  EXPECT_EQ(command->text("task").value(), "t");
  EXPECT_EQ(command->text_or("order", "none").value(), "none");
  EXPECT_FALSE(command->flag("force").value());
  EXPECT_EQ(command->value().value(), type::Value::map({{"x", 1}}));
  EXPECT_GT(command->deadline({}).value(), monotonic_now());
  EXPECT_TRUE(command->only({"task", "yaml", "timeout_s"}));
  EXPECT_FALSE(command->only({"task", "yaml"}));
}

TEST(CommandText, ThatIsNoCommandIsRefused) {
  const std::string deep = R"({"id":1,"verb":")" + std::string(300, '[') + "\"}";
  for (const std::string& text :
       {std::string(), std::string("\0\xff", 2), std::string("[]"), std::string("{}"), std::string("3"),
        std::string(R"({"id": -1, "verb": "a"})"), std::string(R"({"id": 1.5, "verb": "a"})"),
        std::string(R"({"id": "1", "verb": "a"})"), std::string(R"({"id": 1, "verb": 3})"),
        std::string(R"({"id": 1, "verb": "a", "arguments": []})"),
        std::string(R"({"id": 1, "verb": "a", "more": 1})"),
        std::string(R"({"id": 1, "id": 2, "verb": "a"})"),
        std::string(R"({"id": 99999999999999999999, "verb": "a"})"), std::string(300, '['),
        std::string(kLongestCommand + 1, ' ')}) {
    EXPECT_FALSE(Command::parse(text)) << text.substr(0, 80);
  }
  EXPECT_TRUE(Command::parse(deep)) << "brackets in a text";
}

TEST(CommandText, ArgumentsOfOtherKindsAreRefused) {
  const auto command = Command::parse(
      R"({"id": 1, "verb": "a", "arguments": {"n": 1, "t": "x", "l": ["a", 1], "timeout_s": 1e9, "value": 1, "yaml": "1"}})");
  ASSERT_TRUE(command);
  EXPECT_FALSE(command->text("n"));
  EXPECT_FALSE(command->text("missing"));
  EXPECT_FALSE(command->flag("t"));
  EXPECT_FALSE(command->texts("l"));
  EXPECT_FALSE(command->texts("t"));
  EXPECT_FALSE(command->number_or("t", 0));
  EXPECT_FALSE(command->deadline({}));
  EXPECT_FALSE(command->value()) << "both are given";
}

}  // namespace
}  // namespace segue::web
