// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/mission_file_parts.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace segue::mission::detail {

using model::detail::scalar_text;
using type::Value;
using type::ValueMap;

namespace {

class VocabularyCheck {
 public:
  VocabularyCheck(const FactVocabulary& vocabulary, Diagnostics& diagnostics)
      : vocabulary_(vocabulary), diagnostics_(diagnostics) {}

  void run() {
    for (const FactVocabulary::Type& type : vocabulary_.types) {
      const std::string what = "the type " + quote(type.name);
      check_name(type.name, what, type.where);
      if (is_built_in(type.name))
        error("duplicate-name", what + " is there without a declaration", type.where);
      check_type(type.parent, what, false, type.where);
      if (vocabulary_.is_a(type.parent, type.name))
        error("type-cycle", what + " is its own parent", type.where);
    }
    for (const FactVocabulary::Object& object : vocabulary_.objects) {
      const std::string what = "the object " + quote(object.name);
      if (!is_fact_argument(object.name))
        error("bad-name", what + " cannot be an argument of a fact", object.where);
      check_type(object.type, what, false, object.where);
    }
    for (const FactVocabulary::Predicate& predicate : vocabulary_.predicates) {
      const std::string what = "the predicate " + quote(predicate.name);
      check_name(predicate.name, what, predicate.where);
      for (const std::string& type : predicate.arguments)
        check_type(type, what, true, predicate.where);
    }
    if (!vocabulary_.predicates.empty() || vocabulary_.objects.empty()) return;
    diagnostics_.warning("no-predicates",
                         "'objects' has no effect without 'predicates', which says what facts take",
                         vocabulary_.objects.front().where);
  }

 private:
  static bool is_built_in(std::string_view type) {
    return std::ranges::find(FactVocabulary::kBuiltIn, type) != FactVocabulary::kBuiltIn.end();
  }

  void check_name(const std::string& name, const std::string& what, const SourcePlace& where) {
    if (!is_identifier(name)) error("bad-name", what + " must be " + std::string(kIdentifierRule), where);
  }

  /// Objects are of declared types; arguments may also be numbers and the like.
  void check_type(const std::string& type, const std::string& of, bool of_argument,
                  const SourcePlace& where) {
    if (type == "object" || (of_argument && is_built_in(type))) return;
    std::vector<std::string> names{"object"};
    for (const FactVocabulary::Type& declared : vocabulary_.types)
      names.push_back(declared.name);
    if (std::ranges::find(names, type) != names.end()) return;
    error("unknown-type", of + ": there is no type " + quote(type) + did_you_mean(type, names), where);
  }

  void error(std::string code, std::string message, const SourcePlace& where) {
    diagnostics_.error(std::move(code), std::move(message), where);
  }

  const FactVocabulary& vocabulary_;
  Diagnostics& diagnostics_;
};

}  // namespace

FactVocabulary read_vocabulary(Fields& fields, const Source& source) {
  FactVocabulary vocabulary;
  const auto entries = [&](std::string_view key) -> const ValueMap& {
    static const ValueMap none;
    const Value* map = fields.find(key, Value::Kind::Map);
    return map == nullptr ? none : map->as_map();
  };
  for (const auto& [name, parent] : entries("types"))
    vocabulary.types.push_back({name, scalar_text(parent).value_or("object"), source.at(parent)});
  for (const auto& [name, type] : entries("objects"))
    vocabulary.objects.push_back({name, scalar_text(type).value_or("object"), source.at(type)});
  const ValueMap& predicates = entries("predicates");
  if (predicates.empty()) return vocabulary;
  Fields all(*fields.find("predicates"), "'predicates'", source);
  for (const auto& [name, arguments] : predicates)
    vocabulary.predicates.push_back({name, all.texts(name), source.at(arguments)});
  return vocabulary;
}

void write_vocabulary(ValueMap& map, const FactVocabulary& vocabulary) {
  const auto write = [&](std::string_view key, const auto& items, auto value_of) {
    if (items.empty()) return;
    ValueMap entries;
    for (const auto& item : items)
      entries.append(item.name, value_of(item));
    map.append(std::string(key), std::move(entries));
  };
  write("types", vocabulary.types, [](const auto& type) { return Value(type.parent); });
  write("objects", vocabulary.objects, [](const auto& object) { return Value(object.type); });
  write("predicates", vocabulary.predicates, [](const auto& predicate) {
    Value::List types(predicate.arguments.begin(), predicate.arguments.end());
    return Value(std::move(types));
  });
}

void check_vocabulary(const FactVocabulary& vocabulary, Diagnostics& diagnostics) {
  VocabularyCheck(vocabulary, diagnostics).run();
}

}  // namespace segue::mission::detail
