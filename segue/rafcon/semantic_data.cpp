// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rafcon/semantic_data.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace segue::mission {

namespace {

using type::Value;
using type::ValueMap;

/// An entry of an object, by places in the text of the object.
struct Entry {
  std::string key;
  std::size_t lead = 0;   ///< the end of the comma or brace before it
  std::size_t begin = 0;  ///< of its key
  std::size_t value = 0;
  std::size_t end = 0;
};

/// Finds the entries of an object in its text, which is valid JSON.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  std::vector<Entry> entries() {
    std::vector<Entry> found;
    at_ = 1;
    while (true) {
      Entry entry{.key = {}, .lead = at_};
      skip_space();
      if (text_[at_] == '}') return found;
      entry.begin = at_;
      skip_value();
      entry.key = type::parse_json(text_.substr(entry.begin, at_ - entry.begin)).value().as_string();
      skip_space();
      ++at_;  // the colon
      skip_space();
      entry.value = at_;
      skip_value();
      entry.end = at_;
      found.push_back(std::move(entry));
      skip_space();
      if (text_[at_] == ',') ++at_;
    }
  }

 private:
  void skip_space() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  void skip_text() {
    for (++at_; text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }

  void skip_value() {
    std::size_t depth = 0;
    do {
      const char c = text_[at_];
      if (c == '"') {
        skip_text();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') --depth;
      const bool is_word = depth == 0 && c != '}' && c != ']';
      at_ = is_word ? std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size()) : at_ + 1;
    } while (depth > 0);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The code point of the character of valid UTF-8 that begins there; moves past it.
std::uint32_t take_character(std::string_view text, std::size_t& at) {
  const auto first = static_cast<unsigned char>(text[at++]);
  if (first < 0x80U) return first;
  const int more = first >= 0xF0U ? 3 : first >= 0xE0U ? 2 : 1;
  std::uint32_t code = first & (0x3FU >> static_cast<unsigned>(more));
  for (int i = 0; i < more; ++i)
    code = (code << 6U) | (static_cast<unsigned char>(text[at++]) & 0x3FU);
  return code;
}

/// A scalar as Python's json module writes it: in ASCII.
std::string to_ascii(const Value& scalar) {
  const std::string text = type::to_json(scalar, -1);
  std::string ascii;
  const auto escape = [&](std::uint32_t unit) {
    ascii += "\\u";
    for (const unsigned shift : {12U, 8U, 4U, 0U})
      ascii += "0123456789abcdef"[(unit >> shift) & 0xFU];
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::uint32_t code = take_character(text, at);
    if (code < 0x7FU) {
      ascii += static_cast<char>(code);
    } else if (code < 0x10000U) {
      escape(code);
    } else {  // a surrogate pair
      escape(0xD800U + ((code - 0x10000U) >> 10U));
      escape(0xDC00U + ((code - 0x10000U) & 0x3FFU));
    }
  }
  return ascii;
}

/// Writes values in the way in which a file is written already.
class Writer {
 public:
  explicit Writer(std::string_view text)
      : line_end_(text.find("\r\n") != std::string_view::npos ? "\r\n" : "\n"),
        is_one_line_(text.find('\n') == std::string_view::npos &&
                     text.find_first_of(":") != std::string_view::npos),
        // Python 2 left a space at the end of these lines.
        comma_(text.find(", " + line_end_) != std::string_view::npos || is_one_line_ ? ", " : ",") {}

  /// The text of the value as `wanted`, where `text` is its text as `before`.
  [[nodiscard]] std::string merged(std::string_view text, const Value& before, const Value& wanted,
                                   std::size_t indent) const {
    if (before == wanted) return std::string(text);
    const bool has_entries = before.is_map() && !before.as_map().empty();
    if (!has_entries || !wanted.is_map() || wanted.as_map().empty()) return written(wanted, indent);
    return merged_entries(text, before, wanted);
  }

  [[nodiscard]] std::string written(const Value& value, std::size_t indent) const {
    const bool is_list = value.is_list();
    if (!is_list && !value.is_map()) return to_ascii(value);
    std::vector<std::string> items;
    if (is_list) {
      for (const Value& item : value.as_list())
        items.push_back(written(item, indent + kIndent));
    } else {
      auto entries = std::vector<ValueMap::Entry>(value.as_map().begin(), value.as_map().end());
      std::ranges::sort(entries, {}, &ValueMap::Entry::first);
      for (const auto& [key, item] : entries)
        items.push_back(to_ascii(key) + ": " + written(item, indent + kIndent));
    }
    std::string text(is_list ? "[" : "{");
    for (std::size_t i = 0; i < items.size(); ++i)
      text += (i > 0 ? comma_ : "") + line(indent + kIndent) + items[i];
    return text + (items.empty() ? "" : line(indent)) + (is_list ? "]" : "}");
  }

 private:
  static constexpr std::size_t kIndent = 4;

  /// An entry, with the white space before its key and after its value.
  struct Piece {
    std::string key;
    std::string lead;
    std::string body;
    std::string tail;
  };

  [[nodiscard]] std::string line(std::size_t indent) const {
    return is_one_line_ ? "" : line_end_ + std::string(indent, ' ');
  }

  /// The white space before the keys of an object, and how far they are indented.
  struct Layout {
    std::string first;
    std::string next;
    std::size_t indent = 0;
  };

  [[nodiscard]] Layout layout_of(std::string_view text, const std::vector<Entry>& entries) const {
    const auto lead = [&](const Entry& entry) {
      return std::string(text.substr(entry.lead, entry.begin - entry.lead));
    };
    Layout layout{.first = lead(entries.front()), .next = " "};
    const auto line_begin = layout.first.rfind('\n');
    const bool breaks = line_begin != std::string::npos;
    if (breaks) layout.indent = layout.first.size() - line_begin - 1;
    if (breaks) layout.next = comma_.substr(1) + layout.first;
    if (entries.size() > 1) layout.next = lead(entries[1]);
    return layout;
  }

  [[nodiscard]] std::string merged_entries(std::string_view text, const Value& before,
                                           const Value& wanted) const {
    const std::vector<Entry> entries = Scanner(text).entries();
    const Layout layout = layout_of(text, entries);
    const auto between = [&](std::size_t from, std::size_t to) {
      return std::string(text.substr(from, to - from));
    };
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Entry& entry = entries[i];
      const Value* value = wanted.find(entry.key);
      if (value == nullptr) continue;
      const bool is_last = i + 1 == entries.size();
      pieces.push_back(
          {entry.key, i == 0 ? layout.next : between(entry.lead, entry.begin),
           between(entry.begin, entry.value) +
               merged(between(entry.value, entry.end), *before.find(entry.key), *value, layout.indent),
           is_last ? "" : between(entry.end, entries[i + 1].lead - 1)});
    }
    for (const auto& [key, value] : wanted.as_map()) {
      if (before.find(key) != nullptr) continue;
      const auto place =
          std::ranges::find_if(pieces, [&key = key](const Piece& piece) { return key < piece.key; });
      pieces.insert(place, {key, layout.next, to_ascii(key) + ": " + written(value, layout.indent), ""});
    }
    pieces.front().lead = layout.first;
    pieces.back().tail = between(entries.back().end, text.size());
    std::string result = "{";
    for (const Piece& piece : pieces)
      result += (result.size() > 1 ? "," : "") + piece.lead + piece.body + piece.tail;
    return result;
  }

  std::string line_end_;
  bool is_one_line_;
  std::string comma_;
};

Result<void> apply(Value& root, const SemanticEdit& edit) {
  if (edit.keys.empty()) return fail(ErrorCode::InvalidArgument, "an edit of semantic data needs a key");
  Value* around = &root;
  for (std::size_t i = 0; i + 1 < edit.keys.size(); ++i) {
    Value* inner = around->as_map().find(edit.keys[i]);
    if (inner == nullptr && edit.value) inner = &around->as_map().set(edit.keys[i], ValueMap{});
    if (inner == nullptr)
      return fail(ErrorCode::NotFound, "there is no entry " + quote(edit.keys[i]) + " in the semantic data");
    if (!inner->is_map())
      return fail(ErrorCode::InvalidArgument, quote(edit.keys[i]) + " is a value: it has no entries");
    around = inner;
  }
  if (edit.value)
    around->as_map().set(edit.keys.back(), *edit.value);
  else if (!around->as_map().erase(edit.keys.back()))
    return fail(ErrorCode::NotFound,
                "there is no entry " + quote(edit.keys.back()) + " in the semantic data");
  return {};
}

}  // namespace

Result<std::string> edit_semantic_data(std::string_view text, const std::vector<SemanticEdit>& edits) {
  auto before = text.empty() ? Result<Value>(ValueMap{}) : type::parse_json(text);
  if (!before) return before.error();
  if (!before->is_map())
    return fail(ErrorCode::InvalidArgument, "semantic data are entries, not " + describe(*before));
  Value wanted = *before;
  for (const SemanticEdit& edit : edits) {
    if (auto done = apply(wanted, edit); !done) return done.error();
  }
  if (text.empty()) return wanted == *before ? std::string() : Writer(text).written(wanted, 0);
  const std::size_t begin = text.find('{');
  const std::size_t end = text.rfind('}') + 1;
  return std::string(text.substr(0, begin)) +
         Writer(text).merged(text.substr(begin, end - begin), *before, wanted, 0) +
         std::string(text.substr(end));
}

}  // namespace segue::mission
