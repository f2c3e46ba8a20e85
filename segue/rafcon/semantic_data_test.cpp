// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/rafcon/semantic_data.hpp>
#include <segue/type/json.hpp>

#include <support/shared_data.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

namespace segue::mission {
namespace {

using type::Value;
using type::ValueMap;
using Edits = std::vector<SemanticEdit>;

std::string edited_text(std::string_view text, const Edits& edits) {
  const auto result = edit_semantic_data(text, edits);
  EXPECT_TRUE(result) << to_string(result.error());
  return result.value_or("");
}

ErrorCode refusal_of(std::string_view text, const Edits& edits) {
  const auto result = edit_semantic_data(text, edits);
  EXPECT_FALSE(result) << *result;
  return result ? ErrorCode::Internal : result.error().code;
}

constexpr std::string_view kOrder = R"j({
    "RAFCONTPP": {
        "Allow_Override": "False",
        "PDDL_ACTION": {
            "description": {},
            "pddl_action": "(:action order\n :parameters ())"
        }
    },
    "notes": [
        1.50,
        null
    ]
})j";

std::string with(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

TEST(SemanticData, WithoutAChangeKeepsItsBytes) {
  const std::string odd = "\n { \"b\":1.50 ,\t\"a\" : {\"x\":[ 1,{} ]}\r\n}\n";
  for (const std::string& text : {std::string(kOrder), odd, std::string("{}"), std::string()}) {
    EXPECT_EQ(edited_text(text, {}), text);
  }
  EXPECT_EQ(edited_text(odd, {{{"b"}, 1.5}, {{"a", "x"}, Value::list({1, ValueMap{}})}}), odd);
}

TEST(SemanticData, AChangedEntryIsAllThatChanges) {
  EXPECT_EQ(edited_text(kOrder, {{{"RAFCONTPP", "Allow_Override"}, "True"}}),
            with(std::string(kOrder), "\"False\"", "\"True\""));
  const std::string odd = "{\"b\":1.50 ,\t\"a\" : {\"x\":[ 1,{} ],\n\"y\" :2}  }\n";
  EXPECT_EQ(edited_text(odd, {{{"a", "y"}, "z"}}), with(odd, ":2", ":\"z\""));
}

TEST(SemanticData, ANewEntryStandsWhereRafconWritesIt) {
  const std::string text = edited_text(kOrder, {{{"RAFCONTPP", "PDDL_ACTION", "effects"}, "+held()"},
                                                {{"segue", "resources"}, "{block: arm}"},
                                                {{"segue", "effects"}, Value::list({"+a()", ValueMap{}})}});
  const std::string segue = R"j(null
    ],
    "segue": {
        "effects": [
            "+a()",
            {}
        ],
        "resources": "{block: arm}"
    })j";
  EXPECT_EQ(text, with(with(std::string(kOrder), "{},\n", "{},\n            \"effects\": \"+held()\",\n"),
                       "null\n    ]", segue));
  EXPECT_EQ(edited_text("{\n    \"b\": 1\n}", {{{"a"}, 2}}), "{\n    \"a\": 2,\n    \"b\": 1\n}");
}

TEST(SemanticData, AnEntryThatGoesLeavesNothingBehind) {
  EXPECT_EQ(edited_text(kOrder, {{{"RAFCONTPP"}, {}}}),
            "{\n    \"notes\": [\n        1.50,\n        null\n    ]\n}");
  EXPECT_EQ(edited_text(kOrder, {{{"RAFCONTPP", "Allow_Override"}, {}}}),
            with(std::string(kOrder), "        \"Allow_Override\": \"False\",\n", ""));
  EXPECT_EQ(edited_text("{\n    \"a\": 1,\n    \"b\": 2\n}", {{{"b"}, {}}}), "{\n    \"a\": 1\n}");
  EXPECT_EQ(edited_text("{\n    \"a\": 1\n}\n", {{{"a"}, {}}}), "{}\n");
}

TEST(SemanticData, LineEndsAndCommasAreThoseOfTheFile) {
  const std::string windows = with(std::string(kOrder), "\n", "\r\n");
  EXPECT_EQ(edited_text(windows, {{{"segue", "pure"}, "true"}}),
            with(windows, "null\r\n    ]",
                 "null\r\n    ],\r\n    \"segue\": {\r\n        \"pure\": \"true\"\r\n    }"));
  const std::string python2 = with(std::string(kOrder), ",\n", ", \n");
  const std::string more =
      edited_text(python2, {{{"A"}, Value::map({{"x", "1"}, {"y", "2"}})}, {{"z"}, "3"}});
  EXPECT_EQ(
      more,
      with(with(python2, "{\n    \"RAFCONTPP",
                "{\n    \"A\": {\n        \"x\": \"1\", \n        \"y\": \"2\"\n    }, \n    \"RAFCONTPP"),
           "null\n    ]", "null\n    ], \n    \"z\": \"3\""));
  EXPECT_EQ(edited_text(R"({"a": "b"})", {{{"c"}, Value::map({{"d", 1}, {"e", 2}})}}),
            R"({"a": "b", "c": {"d": 1, "e": 2}})");
}

TEST(SemanticData, IsWrittenAsRafconWritesItWhereNoneWas) {
  EXPECT_EQ(edited_text("", {{{"segue", "effects"}, "+hot()"}}),
            "{\n    \"segue\": {\n        \"effects\": \"+hot()\"\n    }\n}");
  EXPECT_EQ(edited_text("{}", {{{"a"}, "Gr\u00f6\u00dfe \u958b \U0001F916 \"\\\n\t\x01\x7f"}}),
            "{\n    \"a\": \"Gr\\u00f6\\u00dfe \\u958b \\ud83e\\udd16 \\\"\\\\\\n\\t\\u0001\\u007f\"\n}");
}

TEST(SemanticData, KeysMayHaveAnyCharacters) {
  const std::string text = R"({
    "a\"}{,:\\": "x",
    "\u00f6": {
        "{": "}"
    }
})";
  EXPECT_EQ(edited_text(text, {{{"a\"}{,:\\"}, "y"}, {{"\u00f6", "{"}, "]"}}),
            with(with(text, "\"x\"", "\"y\""), "\"}\"", "\"]\""));
}

TEST(SemanticData, WhatIsNotThereOrHasNoEntriesIsRefused) {
  EXPECT_EQ(refusal_of(kOrder, {{{}, "x"}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refusal_of(kOrder, {{{"RAFCONTPP", "Allow_Override", "x"}, "y"}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refusal_of(kOrder, {{{"none"}, {}}}), ErrorCode::NotFound);
  EXPECT_EQ(refusal_of(kOrder, {{{"none", "inner"}, {}}}), ErrorCode::NotFound);
  EXPECT_EQ(refusal_of("[1]", {}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refusal_of("{\"a\": 1, \"a\": 2}", {{{"a"}, "y"}}), ErrorCode::ParseError);
}

/// The text of Python's json.dumps(value, indent=4, sort_keys=True), with `comma` between lines.
std::string as_rafcon_writes(const Value& value, const std::string& comma, const std::string& line = "\n") {
  if (!value.is_map() && !value.is_list()) return type::to_json(value, -1);
  std::vector<std::string> items;
  if (value.is_list()) {
    for (const Value& item : value.as_list())
      items.push_back(as_rafcon_writes(item, comma, line + "    "));
  } else {
    for (const auto& [key, item] : value.as_map())
      items.push_back(type::to_json(key, -1) + ": " + as_rafcon_writes(item, comma, line + "    "));
    std::ranges::sort(items);  // keys here are single letters
  }
  std::string text;
  for (const std::string& item : items)
    text += (text.empty() ? "" : comma) + line + "    " + item;
  return (value.is_map() ? "{" : "[") + text + (items.empty() ? "" : line) + (value.is_map() ? "}" : "]");
}

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t end) { return engine_() % end; }

 private:
  std::mt19937_64 engine_;
};

std::string random_key(Dice& random) {
  return std::string(1, static_cast<char>('a' + random.below(6)));
}

Value random_value(Dice& random, int depth) {
  const auto kind = random.below(depth > 0 ? 7U : 4U);
  if (kind == 0) return static_cast<int>(random.below(9));
  if (kind <= 3) return std::string(random.below(4), ',') + random_key(random) + "\": {";
  if (kind == 4) return Value::list({random_value(random, depth - 1), random_value(random, depth - 1)});
  ValueMap map;
  for (auto left = random.below(5); left > 0; --left)
    map.set(random_key(random), random_value(random, depth - 1));
  return map;
}

/// A random change, made to `value`, too.
SemanticEdit random_edit(Dice& random, Value& value) {
  SemanticEdit edit;
  Value* around = &value;
  while (true) {
    edit.keys.push_back(random_key(random));
    Value* inner = around->as_map().find(edit.keys.back());
    if (inner == nullptr || !inner->is_map() || random.below(3) == 0) break;
    around = inner;
  }
  const bool goes = around->find(edit.keys.back()) != nullptr && random.below(2) == 0;
  if (!goes) edit.value = random_value(random, 2);
  if (goes)
    around->as_map().erase(edit.keys.back());
  else
    around->as_map().set(edit.keys.back(), *edit.value);
  return edit;
}

RC_GTEST_PROP(SemanticDataProperty, AnEditedFileOfRafconIsTheOneThatRafconWouldWrite, (std::uint64_t seed)) {
  Dice random(seed);
  Value value = ValueMap{};
  for (int i = 0; i < 5; ++i)
    (void)random_edit(random, value);
  const std::string comma = random.below(2) == 0 ? "," : ", ";
  const std::string text = as_rafcon_writes(value, comma);
  if (comma == ", ") RC_PRE(text.find(", \n") != std::string::npos);
  Value wanted = value;
  Edits edits;
  for (auto left = 1 + random.below(4); left > 0; --left)
    edits.push_back(random_edit(random, wanted));
  const auto result = edit_semantic_data(text, edits);
  RC_LOG() << text << "\n";
  RC_ASSERT(result.has_value());
  RC_ASSERT(*result == as_rafcon_writes(wanted, comma));
}

RC_GTEST_PROP(SemanticDataProperty, AnyFileSaysAfterwardsWhatTheEditsSay, (std::uint64_t seed)) {
  Dice random(seed);
  Value value = ValueMap{};
  for (int i = 0; i < 5; ++i)
    (void)random_edit(random, value);
  std::string text;
  bool quoted = false;
  for (const char c : type::to_json(value, random.below(2) == 0 ? -1 : 3)) {
    const bool may_have_space = !quoted && std::string_view("{}[],:").find(c) != std::string_view::npos;
    if (c == '"' && (text.empty() || text.back() != '\\')) quoted = !quoted;
    const std::string space = std::string(random.below(3) == 0 ? 1U : 0U, " \n\t\r"[random.below(4)]);
    text += may_have_space ? space + c + space : std::string(1, c);
  }
  Value wanted = value;
  Edits edits;
  for (auto left = 1 + random.below(4); left > 0; --left)
    edits.push_back(random_edit(random, wanted));
  RC_LOG() << text << "\n";
  const auto result = edit_semantic_data(text, edits);
  RC_ASSERT(result.has_value());
  const auto read = type::parse_json(*result);
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == wanted);
}

TEST(SemanticDataSharedData, OfRealMachinesComesBackToItsBytes) {
  if (const auto missing = missing_shared_data("rafcon"); !missing.empty()) GTEST_SKIP() << missing;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(shared_data("rafcon"))) {
    if (entry.path().filename() != "semantic_data.json") continue;
    ++files;
    const std::string text = read_file(entry.path()).value();
    const std::string more =
        edited_text(text, {{{"segue", "effects"}, "[\"+at(robot, table)\"]"}, {{"A"}, "x"}});
    EXPECT_NE(more, text);
    EXPECT_EQ(edited_text(more, {{{"segue"}, {}}, {{"A"}, {}}}), text) << entry.path();
    const auto read = type::parse_json(more);
    ASSERT_TRUE(read) << entry.path();
    EXPECT_EQ(read->find("segue")->find("effects")->as_string(), "[\"+at(robot, table)\"]");
  }
  EXPECT_GT(files, 100U);
}

TEST(SemanticDataSharedData, OfEachStateOfARealMachineAreAllThatItsEditsChange) {
  const std::string name =
      "rafcon/DLR-RM+RAFCON/tests/assets/unit_test_state_machines/execution_file_log_test";
  if (const auto missing = missing_shared_data(name); !missing.empty()) GTEST_SKIP() << missing;
  const auto edited_file = [](const std::filesystem::path& file) -> Result<std::string> {
    auto text = read_file(file);
    if (file.filename() != "semantic_data.json") return text;
    return edit_semantic_data(text.value_or(""), {{{"notes", "by"}, file.parent_path().filename().string()}});
  };
  Diagnostics diagnostics;
  const auto before = import_rafcon(shared_data(name), {}, diagnostics);
  auto after = import_rafcon(shared_data(name), {}, diagnostics, edited_file);
  ASSERT_TRUE(before && after) << to_string(diagnostics);
  EXPECT_EQ(after->counts, before->counts);
  EXPECT_GT(after->mission.states.size(), 5U);
  for (State& state : after->mission.states) {
    const Value* notes = state.notes.find("notes");
    ASSERT_NE(notes, nullptr) << state.id.str();
    const std::string folder = std::filesystem::path(state.where.file).parent_path().filename().string();
    EXPECT_EQ(*notes, Value::map({{"by", folder}}));
    state.notes.as_map().erase("notes");
  }
  EXPECT_TRUE(after->mission == before->mission);
}

}  // namespace
}  // namespace segue::mission
