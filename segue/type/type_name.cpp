// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/type.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace segue::type {
namespace {

constexpr std::size_t kLongestName = 4096;
constexpr std::size_t kDeepestName = 32;
constexpr std::size_t kMostSuffixes = 16;

/// One step of a path: "vector</double>" is the name "vector" with one argument.
struct Part {
  std::string name;
  std::vector<std::string> arguments;
};

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The fixed-width name of C++'s built-in integers, whatever the order of their words ("int long unsigned");
/// "" where the words do not make one. char is signed, as typelib has it; long has 64 bits (LP64).
std::string integer_name(const std::vector<std::string>& words) {
  const auto count = [&](std::string_view word) { return std::ranges::count(words, word); };
  const auto is_unsigned = count("unsigned");
  const auto is_signed = count("signed");
  const auto longs = count("long");
  const auto shorts = count("short");
  const auto chars = count("char");
  const auto ints = count("int");
  const auto known = is_unsigned + is_signed + longs + shorts + chars + ints;
  if (known != std::ssize(words) || is_unsigned + is_signed > 1 || shorts + chars > 1 || longs > 2 ||
      ints > 1)
    return {};
  if (chars + (longs > 0 ? 1 : 0) + shorts > 1 || (chars > 0 && ints > 0)) return {};
  const char* bits = "32";
  if (chars > 0) bits = "8";
  if (shorts > 0) bits = "16";
  if (longs > 0) bits = "64";
  return std::string(is_unsigned > 0 ? "/uint" : "/int") + bits + "_t";
}

/// The canonical name of types that C and C++ spell without a namespace or in std and boost; "" for others.
std::string plain_name(std::string_view name, bool in_library) {
  static constexpr std::array<std::string_view, 8> kFixed = {"int8_t",  "int16_t",  "int32_t",  "int64_t",
                                                             "uint8_t", "uint16_t", "uint32_t", "uint64_t"};
  if (std::ranges::find(kFixed, name) != kFixed.end()) return "/" + std::string(name);
  if (name == "size_t" || name == "uintptr_t") return "/uint64_t";
  if (name == "ssize_t" || name == "ptrdiff_t" || name == "intptr_t") return "/int64_t";
  if (in_library) return {};
  if (name == "string") return "/std/string";
  if (name == "void") return "/nil";
  return {};
}

std::string join(const std::vector<Part>& parts) {
  std::string text;
  for (const Part& part : parts) {
    text += "/" + part.name;
    if (part.arguments.empty()) continue;
    for (std::size_t i = 0; i < part.arguments.size(); ++i)
      text += (i == 0 ? "<" : ",") + part.arguments[i];
    text += ">";
  }
  return text;
}

bool is_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

/// Library templates whose typelib name is not their C++ name.
void simplify(std::vector<Part>& parts, std::string& result) {
  if (parts.size() != 2) return;
  Part& part = parts.back();
  std::vector<std::string>& arguments = part.arguments;
  if (parts.front().name == "std" || parts.front().name == "boost") {
    if (arguments.empty()) result = plain_name(part.name, true);
    if (part.name == "array" && arguments.size() == 2 && is_number(arguments[1]))
      result = arguments[0] + "[" + arguments[1] + "]";
  }
  if (parts.front().name != "std") return;
  if (part.name == "basic_string" && !arguments.empty() && arguments[0] == "/int8_t") result = "/std/string";
  if (part.name == "vector" && arguments.size() == 2 && arguments[1].starts_with("/std/allocator<"))
    arguments.pop_back();
}

class NameParser {
 public:
  explicit NameParser(std::string_view text) : text_(text) {}

  Result<std::string> parse() {
    if (text_.size() > kLongestName) return problem("is too long");
    Result<std::string> name = parse_type(0);
    if (!name) return name;
    skip_spaces();
    if (at_ == text_.size()) return name;
    if (text_[at_] == '>') return problem("has a '>' without '<'");
    if (text_[at_] == ']') return problem("has a ']' without '['");
    return out_of_place();
  }

 private:
  Error problem(std::string_view what) const {
    return fail(ErrorCode::ParseError, "type name " + quote(text_) + " " + std::string(what));
  }

  Error out_of_place() const {
    if (at_ >= text_.size()) return problem("ends too early");
    return problem("has " + quote(text_.substr(at_, 1)) + " out of place at character " +
                   std::to_string(at_ + 1));
  }

  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t'))
      ++at_;
  }

  bool accept(std::string_view token) {
    skip_spaces();
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }

  bool accept_separator() { return accept("::") || accept("/"); }

  std::vector<std::string> parse_words() {
    std::vector<std::string> words;
    for (skip_spaces(); at_ < text_.size() && is_letter(text_[at_]); skip_spaces()) {
      const std::size_t begin = at_;
      while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_])))
        ++at_;
      words.emplace_back(text_.substr(begin, at_ - begin));
    }
    return words;
  }

  Result<std::string> parse_number() {
    const std::size_t begin = at_;
    if (text_[at_] == '-') ++at_;
    while (at_ < text_.size() && is_digit(text_[at_]))
      ++at_;
    if (!is_digit(text_[at_ - 1])) return out_of_place();
    return std::string(text_.substr(begin, at_ - begin));
  }

  /// After "<": types and integers up to ">".
  Result<void> parse_arguments(std::vector<std::string>& arguments, std::size_t depth) {
    do {
      skip_spaces();
      const bool number = at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '-');
      if (at_ == text_.size()) return problem("has a '<' that is not closed");
      Result<std::string> argument = number ? parse_number() : parse_type(depth + 1);
      if (!argument) return argument.error();
      arguments.push_back(std::move(*argument));
    } while (accept(","));
    if (accept(">")) return {};
    skip_spaces();
    return at_ == text_.size() ? problem("has a '<' that is not closed") : out_of_place();
  }

  /// One step of a path; integers of several words become their fixed-width name.
  Result<Part> parse_part(std::size_t depth) {
    const std::vector<std::string> words = parse_words();
    if (words.empty()) return out_of_place();
    Part part{words.front(), {}};
    if (std::string integer = integer_name(words); !integer.empty()) {
      part.name = integer.substr(1);
    } else if (words.size() > 1) {
      static constexpr std::array<std::string_view, 4> kTags = {"struct", "class", "union", "enum"};
      const bool tagged = words.size() == 2 && std::ranges::find(kTags, words.front()) != kTags.end();
      if (!tagged) return problem("has the words " + quote(words[0] + " " + words[1]) + " side by side");
      part.name = words[0] + " " + words[1];
    }
    if (accept("<")) {
      if (auto closed = parse_arguments(part.arguments, depth); !closed) return closed.error();
    }
    return part;
  }

  Result<void> parse_suffixes(std::string& name) {
    for (std::size_t suffixes = 0;; ++suffixes) {
      if (suffixes > kMostSuffixes) return problem("has too many dimensions");
      if (accept("*")) {
        name += "*";
      } else if (accept("[")) {
        skip_spaces();
        const std::size_t begin = at_;
        while (at_ < text_.size() && is_digit(text_[at_]))
          ++at_;
        const std::string_view count = text_.substr(begin, at_ - begin);
        if (at_ == text_.size()) return problem("has a '[' that is not closed");
        if (count.empty() || !accept("]")) return out_of_place();
        name += "[" + std::string(count) + "]";
      } else {
        return {};
      }
    }
  }

  Result<std::string> parse_type(std::size_t depth) {
    if (depth > kDeepestName) return problem("is nested too deeply");
    std::vector<Part> parts;
    accept_separator();
    do {
      Result<Part> part = parse_part(depth);
      if (!part) return part.error();
      parts.push_back(std::move(*part));
    } while (accept_separator());
    std::string name;
    if (parts.size() == 1 && parts.front().arguments.empty()) name = plain_name(parts.front().name, false);
    simplify(parts, name);
    if (name.empty()) name = join(parts);
    if (auto suffixes = parse_suffixes(name); !suffixes) return suffixes.error();
    return name;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<std::string> canonical_type_name(std::string_view name) {
  return NameParser(name).parse();
}

}  // namespace segue::type
