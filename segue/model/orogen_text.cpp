// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/orogen_text.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

namespace segue::model::detail {

using type::Mark;
using type::Value;

namespace {

enum class TokenKind : std::uint8_t { Name, Text, Symbol, Number, Pattern, Sign, LineEnd };

struct Token {
  TokenKind kind = TokenKind::LineEnd;
  std::string text;
  Mark where;
  bool is_literal = true;  ///< of a text: it has nothing to evaluate
};

bool starts_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool continues_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

class Tokenizer {
 public:
  explicit Tokenizer(std::string_view text) : text_(text) {}

  Result<std::vector<Token>> run() {
    while (at_ < text_.size()) {
      if (auto read = next(); !read) return read.error();
    }
    add(TokenKind::LineEnd, {});
    return std::move(tokens_);
  }

 private:
  [[nodiscard]] char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  [[nodiscard]] Mark here() const { return {line_, static_cast<std::uint32_t>(at_ - line_begin_ + 1)}; }
  void add(TokenKind kind, std::string text) { tokens_.push_back({kind, std::move(text), here(), true}); }

  Result<void> next() {
    const char c = peek();
    if (c == '\n') return end_line();
    if (std::isspace(static_cast<unsigned char>(c)) != 0 || (c == '\\' && peek(1) == '\n')) {
      skip_space();
      return {};
    }
    if (c == '#') {
      skip_line();
      return {};
    }
    if (c == '"' || c == '\'') return read_text(c, TokenKind::Text);
    if (c == '/' && begins_pattern()) return read_text('/', TokenKind::Pattern);
    if (c == ':' && (peek(1) == '"' || peek(1) == '\'') && !follows_name()) {
      ++at_;
      return read_text(peek(), TokenKind::Symbol);
    }
    if (c == ':' && starts_name(peek(1)) && !follows_name()) return read_name(TokenKind::Symbol, 1);
    if (starts_name(c)) return read_name(TokenKind::Name, 0);
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) return read_number();
    return read_sign();
  }

  Result<void> end_line() {
    add(TokenKind::LineEnd, {});
    ++at_;
    begin_line();
    if (!text_.substr(at_).starts_with("=begin")) return {};
    const auto end = text_.find("\n=end", at_);
    const std::size_t stop = end == std::string_view::npos ? text_.size() : end + 5;
    while (at_ < stop) {
      if (text_[at_++] == '\n') begin_line();
    }
    skip_line();
    return {};
  }

  void begin_line() {
    ++line_;
    line_begin_ = at_;
  }

  void skip_space() {
    if (peek() != '\\') {
      ++at_;
      return;
    }
    at_ += 2;  // the statement goes on in the next line
    begin_line();
  }

  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  /// Whether a '/' begins a regular expression, and does not divide.
  [[nodiscard]] bool begins_pattern() const {
    if (tokens_.empty()) return true;
    const Token& before = tokens_.back();
    if (before.kind == TokenKind::Sign) return before.text != ")" && before.text != "]";
    return before.kind == TokenKind::LineEnd ||
           (before.kind == TokenKind::Name && peek(1) != ' ' && at_ > 0 && text_[at_ - 1] == ' ');
  }

  /// Whether a colon belongs to the name before it, as in `A::B` and `key: value`.
  [[nodiscard]] bool follows_name() const {
    return at_ > 0 && (continues_name(text_[at_ - 1]) || text_[at_ - 1] == ':');
  }

  Result<void> read_text(char quote, TokenKind kind) {
    Token token{kind, {}, here(), true};
    const std::uint32_t line = line_;
    for (++at_; peek() != quote; ++at_) {
      if (at_ >= text_.size())
        return fail(ErrorCode::ParseError, "line " + std::to_string(line) + ": a text is not closed");
      if (peek() == '#' && peek(1) == '{' && quote != '\'') token.is_literal = false;
      if (peek() == '\\' && at_ + 1 < text_.size()) {
        ++at_;
        if (kind == TokenKind::Pattern && peek() != '/') token.text += '\\';
      }
      token.text += peek();
      if (peek() == '\n') {
        ++at_;
        begin_line();
        --at_;
      }
    }
    ++at_;
    tokens_.push_back(std::move(token));
    return {};
  }

  Result<void> read_name(TokenKind kind, std::size_t skip) {
    Token token{kind, {}, here(), true};
    at_ += skip;
    while (continues_name(peek()) || (peek() == ':' && peek(1) == ':' && starts_name(peek(2)))) {
      const std::size_t length = peek() == ':' ? 2 : 1;
      token.text += text_.substr(at_, length);
      at_ += length;
    }
    if (peek() == '?' || (peek() == '!' && peek(1) != '=')) token.text += text_[at_++];
    tokens_.push_back(std::move(token));
    return {};
  }

  Result<void> read_number() {
    Token token{TokenKind::Number, {}, here(), true};
    const auto goes_on = [this] {
      const char c = peek();
      const bool after_exponent = at_ > 0 && (text_[at_ - 1] == 'e' || text_[at_ - 1] == 'E');
      return continues_name(c) || (c == '.' && std::isdigit(static_cast<unsigned char>(peek(1))) != 0) ||
             ((c == '+' || c == '-') && after_exponent);
    };
    for (; goes_on(); ++at_) {
      if (peek() != '_') token.text += peek();
    }
    tokens_.push_back(std::move(token));
    return {};
  }

  Result<void> read_sign() {
    const bool arrow = peek() == '=' && peek(1) == '>';
    add(TokenKind::Sign, std::string(text_.substr(at_, arrow ? 2 : 1)));
    at_ += arrow ? 2 : 1;
    return {};
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
  std::size_t line_begin_ = 0;
  std::vector<Token> tokens_;
};

bool is_sign(const Token& token, std::string_view text) {
  return token.kind == TokenKind::Sign && token.text == text;
}

bool is_name(const Token& token, std::string_view text) {
  return token.kind == TokenKind::Name && token.text == text;
}

std::optional<Value> number_of(const std::string& text) {
  const char* const end = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto [rest, status] = std::from_chars(text.data(), end, whole);
      status == std::errc{} && rest == end)
    return Value(whole);
  double number = 0;
  const auto [rest, status] = std::from_chars(text.data(), end, number);
  return status == std::errc{} && rest == end ? std::optional(Value(number)) : std::nullopt;
}

/// Reads the tokens of one statement.
class StatementReader {
 public:
  StatementReader(const Token* begin, const Token* end) : at_(begin), end_(end) {}

  RubyStatement read() {
    RubyStatement statement;
    statement.where = at_->where;
    if (is_name(*at_, "end")) {
      statement.closes_block = true;
      return statement;
    }
    constexpr std::array<std::string_view, 9> kBlocks = {"if",  "unless", "while",  "until", "case",
                                                         "def", "class",  "module", "begin"};
    statement.opens_block = std::ranges::any_of(kBlocks, [this](auto word) { return is_name(*at_, word); });
    statement.understood = !statement.opens_block && read_calls(statement) && at_ == end_;
    statement.opens_block = statement.opens_block || (!statement.understood && has_do());
    return statement;
  }

 private:
  [[nodiscard]] bool more() const { return at_ != end_; }
  [[nodiscard]] bool sign(std::string_view text) const { return more() && is_sign(*at_, text); }
  bool take(std::string_view text) {
    const bool taken = sign(text);
    if (taken) ++at_;
    return taken;
  }
  [[nodiscard]] bool has_do() const {
    return std::any_of(at_, end_, [](const Token& token) { return is_name(token, "do"); });
  }

  bool read_calls(RubyStatement& statement) {
    do {
      if (!more() || at_->kind != TokenKind::Name) return false;
      RubyCall call;
      call.name = (at_++)->text;
      const bool brackets = take("(");
      const bool arguments = brackets ? !sign(")") : begins_arguments();
      if (arguments && !read_arguments(call)) return false;
      if (brackets && !take(")")) return false;
      statement.calls.push_back(std::move(call));
    } while (take("."));
    if (!more() || !is_name(*at_, "do")) return true;
    ++at_;
    statement.opens_block = true;
    if (take("|")) {
      while (more() && !sign("|"))
        ++at_;
      return take("|");
    }
    return true;
  }

  [[nodiscard]] bool begins_arguments() const {
    return more() && !is_name(*at_, "do") && (at_->kind != TokenKind::Sign || sign("[") || sign("-"));
  }

  bool read_arguments(RubyCall& call) {
    do {
      if (auto key = read_key()) {
        auto value = read_value();
        if (!value) return false;
        call.options.set(std::move(*key), std::move(*value));
      } else {
        auto value = read_value();
        if (!value) return false;
        call.arguments.push_back(std::move(*value));
      }
    } while (take(","));
    return true;
  }

  /// `key: `, `:key =>` and `"key" =>`.
  std::optional<std::string> read_key() {
    if (end_ - at_ < 3) return std::nullopt;
    const bool colon = at_->kind == TokenKind::Name && is_sign(at_[1], ":");
    const bool arrow = is_sign(at_[1], "=>");
    if (!colon && !arrow) return std::nullopt;
    at_ += 2;
    return at_[-2].text;
  }

  std::optional<Value> read_value() {
    if (!more()) return std::nullopt;
    const Token& first = *at_++;
    auto value = value_of(first);
    if (value) value->set_mark(first.where);
    return value;
  }

  std::optional<Value> value_of(const Token& first) {
    switch (first.kind) {
      case TokenKind::Text:
        return read_texts(first);
      case TokenKind::Pattern:
        return first.is_literal ? std::optional(Value(first.text)) : std::nullopt;
      case TokenKind::Symbol:
        return first.is_literal ? std::optional(Value(":" + first.text)) : std::nullopt;
      case TokenKind::Number:
        return number_of(first.text);
      case TokenKind::Name:
        if (first.text == "true" || first.text == "false") return Value(first.text == "true");
        if (first.text == "ro_ptr" && take("(")) return read_pointed_to();
        return first.text == "nil" ? std::optional(Value()) : std::nullopt;
      case TokenKind::Sign:
        if (first.text == "-" && more() && at_->kind == TokenKind::Number)
          return number_of("-" + (at_++)->text);
        return first.text == "[" ? read_list() : std::nullopt;
      case TokenKind::LineEnd:
        break;
    }
    return std::nullopt;
  }

  /// Texts one after the other, or added, are one.
  std::optional<Value> read_texts(const Token& first) {
    std::string text = first.text;
    bool is_literal = first.is_literal;
    while (more() && (at_->kind == TokenKind::Text ||
                      (is_sign(*at_, "+") && end_ - at_ > 1 && at_[1].kind == TokenKind::Text))) {
      take("+");
      is_literal = is_literal && at_->is_literal;
      text += (at_++)->text;
    }
    return is_literal ? std::optional(Value(std::move(text))) : std::nullopt;
  }

  /// `ro_ptr("/base/Pose")` is the type of a read-only pointer, as which all samples are passed.
  std::optional<Value> read_pointed_to() {
    auto type = read_value();
    return take(")") ? std::move(type) : std::nullopt;
  }

  /// Lists in lists have no meaning in oroGen, so there is one level only.
  std::optional<Value> read_list() {
    Value::List items;
    while (!take("]")) {
      if (sign("[")) return std::nullopt;
      auto item = read_value();
      if (!item || (!take(",") && !sign("]"))) return std::nullopt;
      items.push_back(std::move(*item));
    }
    return Value(std::move(items));
  }

  const Token* at_;
  const Token* end_;
};

/// Whether a statement goes on behind this line end.
bool goes_on(const std::vector<Token>& tokens, std::size_t begin, std::size_t line_end, std::size_t depth) {
  if (depth > 0) return true;
  if (line_end > begin) {
    const Token& last = tokens[line_end - 1];
    for (const std::string_view sign : {",", ".", "+", "=>"}) {
      if (is_sign(last, sign)) return true;
    }
  }
  std::size_t next = line_end;
  while (next < tokens.size() && tokens[next].kind == TokenKind::LineEnd)
    ++next;
  return line_end > begin && next < tokens.size() && is_sign(tokens[next], ".");
}

std::size_t depth_after(const Token& token, std::size_t depth) {
  if (is_sign(token, "(") || is_sign(token, "[") || is_sign(token, "{")) return depth + 1;
  const bool closes = is_sign(token, ")") || is_sign(token, "]") || is_sign(token, "}");
  return closes && depth > 0 ? depth - 1 : depth;
}

}  // namespace

Result<std::vector<RubyStatement>> read_ruby(std::string_view text, const std::string& file) {
  auto tokens = Tokenizer(text).run();
  if (!tokens) return fail(ErrorCode::ParseError, file + ": " + tokens.error().message);
  std::vector<RubyStatement> statements;
  std::vector<Token> statement;
  std::size_t begin = 0;
  std::size_t depth = 0;
  for (std::size_t i = 0; i < tokens->size(); ++i) {
    const Token& token = (*tokens)[i];
    const bool ends = is_sign(token, ";") && depth == 0;
    if (token.kind != TokenKind::LineEnd && !ends) {
      depth = depth_after(token, depth);
      statement.push_back(token);
      continue;
    }
    if (!ends && goes_on(*tokens, begin, i, depth)) continue;
    if (!statement.empty())
      statements.push_back(StatementReader(statement.data(), statement.data() + statement.size()).read());
    statement.clear();
    begin = i + 1;
  }
  if (depth > 0) return fail(ErrorCode::ParseError, file + ": a bracket is not closed");
  return statements;
}

}  // namespace segue::model::detail
