// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_text.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace segue::pddl::detail {

namespace {

class Parser {
 public:
  Parser(std::string_view text, const std::string& file, Diagnostics& diagnostics)
      : text_(text), file_(file), diagnostics_(diagnostics) {}

  std::optional<std::vector<PddlTerm>> parse() {
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
    std::vector<PddlTerm> terms;
    for (skip(); place_ < text_.size(); skip()) {
      auto parsed = term(0);
      if (!parsed) return std::nullopt;
      terms.push_back(std::move(*parsed));
    }
    return terms;
  }

 private:
  static constexpr int kDeepest = 200;
  static constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

  [[nodiscard]] SourceLocation here() const { return {file_, line_, column_}; }

  void step() {
    if (text_[place_++] == '\n') {
      ++line_;
      column_ = 1;
    } else {
      ++column_;
    }
  }

  void skip() {
    while (place_ < text_.size()) {
      if (text_[place_] == ';') {
        while (place_ < text_.size() && text_[place_] != '\n')
          step();
      } else if (std::isspace(static_cast<unsigned char>(text_[place_])) != 0) {
        step();
      } else {
        return;
      }
    }
  }

  std::optional<PddlTerm> term(int depth) {
    PddlTerm result;
    result.where = here();
    if (depth > kDeepest) return refuse("nested too deeply", result.where);
    if (text_[place_] == ')') return refuse("a ')' without its '('", result.where);
    if (text_[place_] != '(') {
      result.word = word();
      return result;
    }
    step();
    for (skip(); place_ < text_.size() && text_[place_] != ')'; skip()) {
      auto inner = term(depth + 1);
      if (!inner) return std::nullopt;
      result.list.push_back(std::move(*inner));
    }
    if (place_ == text_.size()) return refuse("a '(' without its ')'", result.where);
    step();
    return result;
  }

  std::string word() {
    std::string word;  // a '?' begins another one, blank or not
    while (place_ < text_.size() && std::string_view("();").find(text_[place_]) == std::string_view::npos &&
           (text_[place_] != '?' || word.empty()) &&
           std::isspace(static_cast<unsigned char>(text_[place_])) == 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[place_])));
      step();
    }
    return word;
  }

  std::optional<PddlTerm> refuse(std::string what, SourceLocation where) {
    diagnostics_.error("parse-error", std::move(what), std::move(where));
    return std::nullopt;
  }

  std::string_view text_;
  const std::string& file_;
  Diagnostics& diagnostics_;
  std::size_t place_ = 0;
  int line_ = 1;
  int column_ = 1;
};

std::vector<std::string> read_types(const PddlTerm& term, Diagnostics& diagnostics) {
  if (!term.is_list()) return {term.word};
  std::vector<std::string> types;
  for (std::size_t i = 1; i < term.list.size(); ++i)
    types.push_back(term.list[i].word);
  if (!term.begins_with("either") || types.empty())
    diagnostics.error("bad-type", "a type is a name or (either ...)", term.where);
  return types;
}

}  // namespace

std::optional<std::vector<PddlTerm>> parse_pddl(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics) {
  return Parser(text, file, diagnostics).parse();
}

std::optional<double> number_in(std::string_view text) {
  if (text.empty() || text.front() < '0' || text.front() > '9') return std::nullopt;
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool begins_with_definition(std::string_view text) {
  constexpr std::string_view kDefine = "define";
  for (;;) {
    const auto first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf(");
    if (first == std::string_view::npos) return false;
    const bool in_list = text.substr(0, first).find('(') != std::string_view::npos;
    text.remove_prefix(first);
    if (text.front() != ';') {
      const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
      return in_list && std::ranges::equal(text.substr(0, kDefine.size()), kDefine, same);
    }
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end);
  }
}

namespace {

/// The terms with "-t" divided into two words.
std::vector<PddlTerm> with_dashes_apart(const std::vector<PddlTerm>& terms, std::size_t first) {
  std::vector<PddlTerm> result;
  for (std::size_t i = first; i < terms.size(); ++i) {
    const PddlTerm& term = terms[i];
    if (!term.word.starts_with('-')) {
      result.push_back(term);
      continue;
    }
    result.push_back({"-", {}, term.where});
    if (term.word.size() == 1) continue;
    result.push_back({term.word.substr(1), {}, term.where});
    ++result.back().where.column;
  }
  return result;
}

}  // namespace

std::vector<PddlTyped> read_typed_list(const std::vector<PddlTerm>& given, std::size_t first,
                                       Diagnostics& diagnostics) {
  const std::vector<PddlTerm> terms = with_dashes_apart(given, first);
  std::vector<PddlTyped> result;
  std::size_t untyped = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].word != "-") {
      if (terms[i].is_list()) diagnostics.error("bad-name", "a name was expected here", terms[i].where);
      result.push_back({terms[i].word, {"object"}, terms[i].where});
      continue;
    }
    if (++i == terms.size()) {
      diagnostics.error("bad-type", "a type must follow '-'", terms[i - 1].where);
      break;
    }
    const auto types = read_types(terms[i], diagnostics);
    for (; untyped < result.size(); ++untyped)
      result[untyped].types = types;
  }
  return result;
}

}  // namespace segue::pddl::detail
