// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/script_messages.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace segue::mission::detail {
namespace {

using type::Value;

constexpr std::size_t kLargest = 0xffff;

RC_GTEST_PROP(ScriptMessages, ArriveWholeInWhateverPieces, (const std::vector<std::vector<int>>& lists)) {
  std::string stream;
  std::vector<Value> messages;
  for (const std::vector<int>& numbers : lists) {
    messages.emplace_back(Value::List(numbers.begin(), numbers.end()));
    stream += framed(messages.back(), kLargest).value();
  }
  MessageReader reader(kLargest);
  std::vector<Value> received;
  for (std::size_t at = 0; at < stream.size();) {
    const auto size = *rc::gen::inRange<std::size_t>(1, stream.size() - at + 1);
    reader.append(std::string_view(stream).substr(at, size));
    at += size;
    while (auto message = reader.next().value())
      received.push_back(std::move(*message));
  }
  RC_ASSERT(received == messages);
}

RC_GTEST_PROP(ScriptMessages, AreNeverReadBeyondWhatArrived, (const std::string& noise)) {
  MessageReader reader(kLargest);
  reader.append(noise);
  for (std::size_t i = 0; i <= noise.size(); ++i) {
    const auto message = reader.next();
    if (!message || !*message) return;
  }
  RC_FAIL("more messages than bytes");
}

TEST(ScriptMessages, ThatAreTooLargeAreNotSent) {
  EXPECT_EQ(framed(std::string(kLargest, 'x'), kLargest).error().code, ErrorCode::ResourceExhausted);
}

TEST(ScriptMessages, ThatAreTooLargeAreRefusedBeforeTheyHaveArrived) {
  MessageReader reader(kLargest);
  reader.append(std::string_view("\0\0\x01\0", 4));
  EXPECT_EQ(reader.next().error().code, ErrorCode::ResourceExhausted);
}

TEST(ScriptMessages, ThatAreNoJsonAreRefused) {
  MessageReader reader(kLargest);
  reader.append(std::string_view("\x02\0\0\0{]", 6));
  EXPECT_EQ(reader.next().error().code, ErrorCode::ParseError);
}

TEST(ScriptLines, ArriveWholeOrCut) {
  LineReader reader;
  reader.append("one\ntw");
  EXPECT_EQ(reader.next(), "one");
  EXPECT_EQ(reader.next(), std::nullopt);
  reader.append("o\n\n" + std::string(5000, 'x'));
  EXPECT_EQ(reader.next(), "two");
  EXPECT_EQ(reader.next(), "");
  EXPECT_EQ(reader.next(), std::string(4096, 'x'));
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_EQ(reader.rest(), std::string(904, 'x'));
  EXPECT_EQ(reader.rest(), "");
}

TEST(ScriptAnswers, AreErrorsWhereTheQuestionIsNone) {
  Globals globals;
  for (const Value& request : {Value(), Value::map({{"call", 3}}), Value::map({{"call", "fly"}})})
    EXPECT_NE(answer_about_globals(globals, std::make_shared<ScriptObjects>(), request).find("error"),
              nullptr);
}

TEST(ScriptAnswers, TellALockedVariableFromOneThatIsNotThere) {
  Globals globals;
  const auto objects = std::make_shared<ScriptObjects>();
  const auto get = [&](const std::string& name, Globals::Key key) {
    return answer_about_globals(globals, objects,
                                Value::map({{"call", "get"}, {"name", name}, {"key", key}}));
  };
  const auto key = globals.lock("locked", Duration::zero()).value();
  EXPECT_EQ(*get("nothing", 0).find("value"), Value(Value::List{}));
  EXPECT_TRUE(get("locked", 0).find("value")->is_null());
  EXPECT_EQ(*get("locked", key).find("value"), Value::list({Value()}));
  EXPECT_NE(get("locked", key + 1).find("error"), nullptr);
}

TEST(ScriptAnswers, TellTheProcessWhichObjectsNoVariableHoldsAnyMore) {
  Globals globals;
  const auto objects = std::make_shared<ScriptObjects>();
  const auto ask = [&](const char* call, std::uint64_t number) {
    return answer_about_globals(
        globals, objects, Value::map({{"call", call}, {"name", "v"}, {"object", number}, {"value", "it"}}));
  };
  EXPECT_EQ(ask("set", 1).find("error"), nullptr);
  EXPECT_EQ(*ask("get", 0).find("objects"), Value::map({{"v", 1}}));
  EXPECT_EQ(objects->take_released(), std::vector<std::uint64_t>{});
  EXPECT_EQ(ask("set", 2).find("error"), nullptr);
  EXPECT_EQ(objects->take_released(), std::vector<std::uint64_t>{1});
  EXPECT_EQ(ask("delete", 0).find("error"), nullptr);
  EXPECT_EQ(objects->take_released(), std::vector<std::uint64_t>{2});
}

TEST(ScriptAnswers, PassNoObjectOfAnotherProcess) {
  Globals globals;
  const auto first = std::make_shared<ScriptObjects>();
  const auto second = std::make_shared<ScriptObjects>();
  const Value get = Value::map({{"call", "get"}, {"name", "v"}});
  answer_about_globals(globals, first,
                       Value::map({{"call", "set"}, {"name", "v"}, {"object", 1}, {"value", "it"}}));
  EXPECT_NE(answer_about_globals(globals, second, get).find("error"), nullptr);
  first->end();
  EXPECT_NE(answer_about_globals(globals, first, get).find("error"), nullptr);
  EXPECT_EQ(globals.get("v"), Value("it")) << "what it has shown last";
}

}  // namespace
}  // namespace segue::mission::detail
