// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// Data types, descriptions of C++ types, dynamic values and their codecs.
namespace segue::type {

/// Where in its file a value was written, counted from 1; 0 means unknown.
struct Mark {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// How many levels of lists, maps or types within each other readers and writers accept.
inline constexpr std::size_t kDeepestNesting = 200;

class ValueMap;

/// A dynamic value, such as a property in a file or a sample that `segue read` prints: a tree of null, bool,
/// integers, float, text, lists and maps. Comparison ignores marks and source texts. Not thread safe, freely
/// copied.
class Value {
 public:
  enum class Kind : std::uint8_t { Null, Bool, Int, UInt, Float, String, List, Map };
  using List = std::vector<Value>;

  Value();
  Value(bool boolean);           // NOLINT(google-explicit-constructor)
  Value(int integer);            // NOLINT(google-explicit-constructor)
  Value(std::int64_t integer);   // NOLINT(google-explicit-constructor)
  Value(std::uint64_t integer);  // NOLINT(google-explicit-constructor): Int where it fits, UInt above
  Value(double number);          // NOLINT(google-explicit-constructor)
  Value(std::string text);       // NOLINT(google-explicit-constructor)
  Value(std::string_view text);  // NOLINT(google-explicit-constructor)
  Value(const char* text);       // NOLINT(google-explicit-constructor)
  Value(List list);              // NOLINT(google-explicit-constructor)
  Value(ValueMap map);           // NOLINT(google-explicit-constructor)
  Value(const Value& other);
  Value(Value&& other) noexcept;
  Value& operator=(const Value& other);
  Value& operator=(Value&& other) noexcept;
  ~Value();

  /// A map in one expression: Value::map({{"max", 30.0}, {"min", 0.1}}).
  static Value map(std::initializer_list<std::pair<std::string, Value>> entries);
  static Value list(std::initializer_list<Value> items);

  [[nodiscard]] Kind kind() const;
  [[nodiscard]] bool is_null() const { return kind() == Kind::Null; }
  [[nodiscard]] bool is_bool() const { return kind() == Kind::Bool; }
  /// Int or UInt.
  [[nodiscard]] bool is_integer() const { return kind() == Kind::Int || kind() == Kind::UInt; }
  [[nodiscard]] bool is_number() const { return is_integer() || kind() == Kind::Float; }
  [[nodiscard]] bool is_string() const { return kind() == Kind::String; }
  [[nodiscard]] bool is_list() const { return kind() == Kind::List; }
  [[nodiscard]] bool is_map() const { return kind() == Kind::Map; }

  /// Contents; each requires the kind it names (asserted). as_double accepts every number.
  [[nodiscard]] bool as_bool() const;
  [[nodiscard]] std::int64_t as_int() const;
  [[nodiscard]] std::uint64_t as_uint() const;
  [[nodiscard]] double as_double() const;
  [[nodiscard]] const std::string& as_string() const;
  [[nodiscard]] const List& as_list() const;
  [[nodiscard]] List& as_list();
  [[nodiscard]] const ValueMap& as_map() const;
  [[nodiscard]] ValueMap& as_map();

  /// The entry of a map, or nullptr when there is none or this is not a map.
  [[nodiscard]] const Value* find(std::string_view key) const;

  /// Equal content: numbers by numeric value (10 == 10.0), NaN equals NaN, maps whatever the order of their
  /// keys.
  friend bool operator==(const Value& a, const Value& b);

  [[nodiscard]] Mark mark() const { return mark_; }
  void set_mark(Mark mark) { mark_ = mark; }

  /// The source text of a plain scalar that prints differently ("1.10", "0x1F"); else empty. A string
  /// property takes this text.
  [[nodiscard]] std::string_view source_text() const;
  void set_source_text(std::string text);

 private:
  using Storage = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List,
                               std::unique_ptr<ValueMap>>;
  Storage storage_;
  Mark mark_;
  std::unique_ptr<std::string> source_text_;
};

/// Entries in the order they were written; keys are unique.
class ValueMap {
 public:
  using Entry = std::pair<std::string, Value>;

  /// Sets or replaces.
  Value& set(std::string key, Value value);
  /// The entry; inserted as null if missing.
  Value& operator[](std::string_view key);
  [[nodiscard]] const Value* find(std::string_view key) const;
  [[nodiscard]] Value* find(std::string_view key);
  bool erase(std::string_view key);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] auto begin() const { return entries_.begin(); }
  [[nodiscard]] auto end() const { return entries_.end(); }
  [[nodiscard]] auto begin() { return entries_.begin(); }
  [[nodiscard]] auto end() { return entries_.end(); }

  /// For readers of large files: appends without a search. Requires that the key is new.
  Value& append(std::string key, Value value);

  friend bool operator==(const ValueMap& a, const ValueMap& b);

 private:
  std::vector<Entry> entries_;
};

/// A short readable form for messages: 'far', 30, a list of 3, a map.
std::string describe(const Value& value);

/// The name of a kind in messages: "a number", "text", "a list" ...
std::string_view describe(Value::Kind kind);

/// Deep merge: maps entry by entry, everything else is replaced by `over` (configuration sections: later
/// wins).
void merge(Value& base, const Value& over);

}  // namespace segue::type
