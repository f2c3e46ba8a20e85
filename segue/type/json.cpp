// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/collection.hpp>
#include <segue/type/json.hpp>
#include <segue/type/scalar_text.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::type {
namespace {

/// An input iterator that exposes how far the parser has read, since the parser's events carry no places.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, const char** reached) : at_(at), reached_(reached) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  const char** reached_;
};

/// Turns ascending offsets into lines and columns (in characters).
class Places {
 public:
  explicit Places(std::string_view text) : text_(text) {}

  Mark at(std::size_t offset) {
    for (; offset_ < offset && offset_ < text_.size(); ++offset_) {
      const auto byte = static_cast<unsigned char>(text_[offset_]);
      if (byte == '\n') {
        ++mark_.line;
        mark_.column = 1;
      } else if ((byte & 0xC0U) != 0x80U) {
        ++mark_.column;
      }
    }
    return mark_;
  }

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  Mark mark_{1, 1};
};

bool is_number_character(char c) {
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E';
}

std::string without_prefix(std::string_view message) {
  if (const auto end = message.find("] "); end != std::string_view::npos) message.remove_prefix(end + 2);
  // "parse error at line 1, column 2: what": the place is reported separately.
  if (message.starts_with("parse error")) {
    if (const auto end = message.find(": "); end != std::string_view::npos) message.remove_prefix(end + 2);
  }
  return detail::valid_utf8(message);
}

/// Receives nlohmann's events; a handler that returns false ends the parsing.
class Handler {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  Handler(std::string_view text, const std::string& file)
      : text_(text), file_(file), reached_(text.data()), places_(text) {}

  Result<Value> parse() {
    const CountingIterator begin(text_.data(), &reached_);
    const CountingIterator end(text_.data() + text_.size(), &reached_);
    if (!nlohmann::json::sax_parse(begin, end, this) && !error_) return refuse("invalid JSON", offset());
    if (error_) return *std::move(error_);
    return std::move(root_);
  }

  bool null() { return add(Value(), offset() - 4); }
  bool boolean(bool value) { return add(value, offset() - (value ? 4 : 5)); }
  bool number_integer(number_integer_t value) { return add(Value(std::int64_t{value}), number_begin()); }
  bool number_unsigned(number_unsigned_t value) { return add(Value(std::uint64_t{value}), number_begin()); }
  bool number_float(number_float_t value, const string_t& /*text*/) { return add(value, number_begin()); }
  bool string(string_t& value) {
    const std::size_t begin = string_begin();
    return add(Value(std::move(value)), begin);
  }
  bool binary(binary_t& /*value*/) { return false; }  // only in other formats
  bool start_object(std::size_t /*size*/) { return open(true); }
  bool start_array(std::size_t /*size*/) { return open(false); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(string_t& name) {
    if (open_.back().take_key(name)) return true;
    error_ = refuse("the key " + quote(name) + " occurs twice in this object", string_begin());
    return false;
  }

  bool parse_error(std::size_t /*position*/, const std::string& /*last_token*/,
                   const std::exception& exception) {
    error_ = refuse(without_prefix(exception.what()), std::max<std::size_t>(offset(), 1) - 1);
    return false;
  }

 private:
  [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(reached_ - text_.data()); }

  // The lexer has read one character beyond a number, unless the text ends with it.
  [[nodiscard]] std::size_t number_begin() const {
    std::size_t begin = offset();
    if (begin > 0 && !is_number_character(text_[begin - 1])) --begin;
    while (begin > 0 && is_number_character(text_[begin - 1]))
      --begin;
    return begin;
  }

  // From behind the closing quote back to the opening one: the nearest that no backslash escapes.
  [[nodiscard]] std::size_t string_begin() const {
    std::size_t quote_at = text_.rfind('"', offset() - 2);
    while (backslashes_before(quote_at) % 2 == 1)
      quote_at = text_.rfind('"', quote_at - 1);
    return quote_at;
  }

  [[nodiscard]] std::size_t backslashes_before(std::size_t at) const {
    std::size_t count = 0;
    while (count < at && text_[at - count - 1] == '\\')
      ++count;
    return count;
  }

  Error refuse(std::string message, std::size_t at) {
    const Mark mark = places_.at(at);
    return fail(ErrorCode::ParseError, std::move(message), {},
                {file_, static_cast<int>(mark.line), static_cast<int>(mark.column)});
  }

  bool add(Value value, std::size_t at) {
    value.set_mark(places_.at(at));
    return add(std::move(value));
  }

  bool add(Value value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else {
      open_.back().add(std::move(value));
    }
    return true;
  }

  bool open(bool is_map) {
    if (open_.size() >= kDeepestNesting) {
      error_ =
          refuse("lists and objects are nested deeper than " + std::to_string(kDeepestNesting) + " levels",
                 offset() - 1);
      return false;
    }
    open_.emplace_back(is_map, places_.at(offset() - 1));
    return true;
  }

  bool close() {
    Value value = open_.back().finish();
    open_.pop_back();
    return add(std::move(value));
  }

  std::string_view text_;
  const std::string& file_;
  const char* reached_;
  Places places_;
  Value root_;
  std::vector<detail::Collection> open_;
  std::optional<Error> error_;
};

class Writer {
 public:
  explicit Writer(int indent) : indent_(indent) {}

  std::string write(const Value& value) {
    node(value);
    return std::move(text_);
  }

 private:
  void node(const Value& value) {
    if (value.is_map()) {
      collection('{', '}', value.as_map(), [this](const ValueMap::Entry& entry) {
        string(entry.first);
        text_ += indent_ < 0 ? ":" : ": ";
        node(entry.second);
      });
    } else if (value.is_list()) {
      collection('[', ']', value.as_list(), [this](const Value& item) { node(item); });
    } else if (value.is_string()) {
      string(value.as_string());
    } else {
      const bool lacking = value.kind() == Value::Kind::Float && !std::isfinite(value.as_double());
      text_ += lacking ? "null" : detail::print_scalar(value);
    }
  }

  template <class Entries, class Write>
  void collection(char begin, char end, const Entries& entries, Write write_entry) {
    text_ += begin;
    ++level_;
    bool first = true;
    for (const auto& entry : entries) {
      if (!std::exchange(first, false)) text_ += ',';
      new_line();
      write_entry(entry);
    }
    --level_;
    if (entries.begin() != entries.end()) new_line();
    text_ += end;
  }

  void new_line() {
    if (indent_ < 0) return;
    text_ += '\n';
    text_.append(static_cast<std::size_t>(indent_) * level_, ' ');
  }

  void string(std::string_view content) {
    text_ += '"';
    for (const char c : detail::valid_utf8(content)) {
      if (c == '"' || c == '\\') {
        text_ += '\\';
        text_ += c;
      } else if (static_cast<unsigned char>(c) < 0x20) {
        control(c);
      } else {
        text_ += c;
      }
    }
    text_ += '"';
  }

  void control(char c) {
    constexpr std::string_view kHex = "0123456789abcdef";
    if (c == '\n') {
      text_ += "\\n";
    } else if (c == '\t') {
      text_ += "\\t";
    } else {
      const auto byte = static_cast<unsigned char>(c);
      text_ += "\\u00";
      text_ += kHex[byte >> 4U];
      text_ += kHex[byte & 15U];
    }
  }

  int indent_;
  std::size_t level_ = 0;
  std::string text_;
};

}  // namespace

Result<Value> parse_json(std::string_view text, const std::string& file) {
  if (text.empty())
    return fail(ErrorCode::ParseError, "expected a JSON value, found nothing", {}, {file, 1, 1});
  return Handler(text, file).parse();
}

std::string to_json(const Value& value, int indent) {
  return Writer(indent).write(value);
}

}  // namespace segue::type
