// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/text.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Common parts of file readers, for this folder and those above. Not thread safe.
namespace segue::model::detail {

/// How unknown keys are taken: as mistakes in our own formats, as extensions in formats that other tools
/// write.
enum class UnknownKeys : std::uint8_t { Refuse, Ignore };

/// The file being read, and the diagnostics that collect its problems.
class Source {
 public:
  Source(std::string file, Diagnostics& diagnostics, UnknownKeys unknown_keys = UnknownKeys::Refuse)
      : file_(std::move(file)), diagnostics_(diagnostics), unknown_keys_(unknown_keys) {}

  /// This file, read in the format of another tool: unknown keys are ignored.
  [[nodiscard]] Source foreign() const { return {file_, diagnostics_, UnknownKeys::Ignore}; }
  [[nodiscard]] UnknownKeys unknown_keys() const { return unknown_keys_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] Diagnostics& diagnostics() const { return diagnostics_; }
  [[nodiscard]] SourceLocation at(const type::Value& value) const;
  void error(std::string code, std::string message, const type::Value& value) const;
  void warning(std::string code, std::string message, const type::Value& value) const;

  /// Parses one YAML or JSON document; an error becomes a diagnostic.
  [[nodiscard]] std::optional<type::Value> parse(std::string_view text) const;

 private:
  std::string file_;
  Diagnostics& diagnostics_;
  UnknownKeys unknown_keys_;
};

/// The content of a file; if it cannot be read, nothing, and a diagnostic `unreadable-file`.
std::optional<std::string> read_text(const std::filesystem::path& file, Diagnostics& diagnostics);

/// The text of a scalar as written; nothing for null, lists and maps.
std::optional<std::string> scalar_text(const type::Value& value);

/// Typed access to the entries of a map. Reports entries of a wrong kind, and unknown keys by finish(). A
/// null counts as an empty map, a null entry as absent.
class Fields {
 public:
  /// `what` names the map in messages: "task 'velodyne'". `value` and `source` must outlive this.
  Fields(const type::Value& value, std::string what, const Source& source);

  [[nodiscard]] bool is_map() const { return map_ != nullptr; }
  [[nodiscard]] const std::string& what() const { return what_; }
  [[nodiscard]] const type::Value& value() const { return value_; }

  const type::Value* find(std::string_view key);
  const type::Value* require(std::string_view key, std::string_view hint = {});
  /// The entry if it has that kind; another kind is an error.
  const type::Value* find(std::string_view key, type::Value::Kind kind);

  /// The entries of a list; none where it is absent.
  const type::Value::List& entries(std::string_view key);
  std::string text(std::string_view key);
  /// An identifier, or "" with an error if it is none.
  std::string name(std::string_view key);
  std::string required_name(std::string_view key, std::string_view hint = {});
  bool boolean(std::string_view key, bool fallback);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most,
                                      std::string_view code);
  std::optional<Duration> duration(std::string_view key);
  /// Bytes: "512MB".
  std::optional<std::uint64_t> size(std::string_view key, std::string_view code);
  /// A list of texts, or one text as a list of one.
  std::vector<std::string> texts(std::string_view key);
  std::vector<int> integers(std::string_view key, int least, int most);
  /// The position of the entry in `names`.
  template <class Names>
  std::optional<std::size_t> choice(std::string_view key, const Names& names, std::string_view code) {
    const type::Value* value = find(key);
    if (value == nullptr) return std::nullopt;
    return choose(*value, key, {names.begin(), names.end()}, code);
  }

  /// Accepts a key that has no meaning here.
  void ignore(std::string_view key) { known_.push_back(key); }
  /// Reports every key that was not read: an error, in files of other tools a warning.
  void finish();

 private:
  std::optional<std::size_t> choose(const type::Value& value, std::string_view key,
                                    const std::vector<std::string>& names, std::string_view code);
  void wrong_kind(std::string_view key, std::string_view wanted, const type::Value& value);

  const type::Value& value_;
  const type::ValueMap* map_ = nullptr;
  std::string what_;
  const Source& source_;
  std::vector<std::string_view> known_;
};

/// Reports an error and returns false if `name` is not a valid identifier.
bool check_name(std::string_view name, std::string_view what, const type::Value& at, const Source& source);

}  // namespace segue::model::detail
