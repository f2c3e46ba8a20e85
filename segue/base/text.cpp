// SPDX-License-Identifier: Apache-2.0
#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace segue {
namespace {

constexpr std::size_t kLongestQuote = 80;

struct Unit {
  std::string_view name;
  double nanoseconds;
};
constexpr std::array<Unit, 6> kUnits = {
    {{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}, {"min", 60e9}, {"h", 3600e9}}};

struct SizeUnit {
  std::string_view name;
  std::uint64_t bytes;
};
/// In decreasing order: format_size() takes the first that divides the number.
constexpr std::array<SizeUnit, 9> kSizeUnits = {{{"TiB", std::uint64_t{1} << 40},
                                                 {"TB", 1'000'000'000'000},
                                                 {"GiB", std::uint64_t{1} << 30},
                                                 {"GB", 1'000'000'000},
                                                 {"MiB", std::uint64_t{1} << 20},
                                                 {"MB", 1'000'000},
                                                 {"KiB", 1024},
                                                 {"kB", 1000},
                                                 {"B", 1}}};

/// The most candidates that are compared: a file may have thousands of names, and as many mistakes.
constexpr std::size_t kMostCandidates = 1000;

/// `limit` where it is that large or larger.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= limit) return limit;
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    std::size_t least = row[0];
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substitution});
      least = std::min(least, row[j + 1]);
    }
    if (least >= limit) return limit;
  }
  return std::min(row.back(), limit);
}

bool is_word_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

}  // namespace

std::string quote(std::string_view text) {
  std::string_view shown = text.substr(0, kLongestQuote);
  // No character is cut.
  if (shown.size() < text.size()) {
    for (std::size_t begin = kLongestQuote - 3; begin < kLongestQuote; ++begin) {
      if (begin + printable_length(text.substr(begin)) > kLongestQuote) shown = text.substr(0, begin);
    }
  }
  std::string result = "'";
  for (const char c : printable(shown)) {
    if (c == '\n')
      result += "\\n";
    else if (c == '\t')
      result += "\\x09";
    else
      result += c;
  }
  return result + (shown.size() < text.size() ? "...'" : "'");
}

std::string escape_markup(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else if (c == '\'')
      safe += "&#39;";
    else
      safe += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
  }
  return safe;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  if (word.size() > 200) return {};
  for (const std::string& candidate : candidates.first(std::min(candidates.size(), kMostCandidates))) {
    if (candidate.size() > 200) continue;
    const std::size_t distance = edit_distance(word, candidate, best_distance);
    if (distance >= best_distance || distance >= word.size()) continue;
    best_distance = distance;
    best = &candidate;
  }
  return best == nullptr ? std::string{} : ", did you mean " + quote(*best) + "?";
}

std::string did_you_mean_or_list(std::string_view word, std::span<const std::string> candidates,
                                 std::string_view has) {
  constexpr std::size_t kMostListed = 12;
  std::string similar = did_you_mean(word, candidates);
  if (!similar.empty() || candidates.empty()) return similar;
  std::vector<std::string> names(
      candidates.begin(),
      candidates.begin() + static_cast<std::ptrdiff_t>(std::min(candidates.size(), kMostListed)));
  if (candidates.size() > kMostListed)
    names.push_back(std::to_string(candidates.size() - kMostListed) + " more");
  return "; " + std::string(has) + ' ' + listed(names);
}

std::string counted(std::size_t count, std::string_view noun) {
  return std::to_string(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

std::string listed(std::span<const std::string> items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

Result<Duration> parse_duration(std::string_view text) {
  auto refuse = [&] {
    return fail(ErrorCode::InvalidArgument,
                "expected a duration with a unit such as '100ms' or '1.5s', got " + quote(text));
  };
  double number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc{} || !std::isfinite(number)) return refuse();
  std::string_view name(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (name.starts_with(' '))
    name.remove_prefix(1);
  const auto* unit = std::ranges::find(kUnits, name, &Unit::name);
  if (unit == kUnits.end()) return refuse();
  const double nanoseconds = number * unit->nanoseconds;
  if (std::abs(nanoseconds) > 9.2e18) return refuse();
  return Duration(std::llround(nanoseconds));
}

std::string format_duration(Duration duration) {
  const auto count = duration.count();
  if (count == 0) return "0s";
  const Unit* unit = kUnits.data();
  for (const Unit& candidate : std::span(kUnits).first(4)) {
    if (std::abs(static_cast<double>(count)) >= candidate.nanoseconds) unit = &candidate;
  }
  std::array<char, 40> buffer{};
  const double number = static_cast<double>(count) / unit->nanoseconds;
  auto [end, status] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::fixed);
  if (std::llround(number * unit->nanoseconds) == count && status == std::errc{}) {
    return std::string(buffer.data(), end) + std::string(unit->name);
  }
  return std::to_string(count) + "ns";
}

Result<std::uint64_t> parse_size(std::string_view text) {
  auto refuse = [&] {
    return fail(ErrorCode::InvalidArgument,
                "expected a size with a unit such as '512MB' or '64MiB', got " + quote(text));
  };
  std::uint64_t number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc{}) return refuse();
  std::string_view name(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (name.empty() && number == 0) return number;
  while (name.starts_with(' '))
    name.remove_prefix(1);
  const auto* unit = std::ranges::find(kSizeUnits, name, &SizeUnit::name);
  if (unit == kSizeUnits.end()) return refuse();
  if (number > std::numeric_limits<std::uint64_t>::max() / unit->bytes) return refuse();
  return number * unit->bytes;
}

std::string format_size(std::uint64_t bytes) {
  if (bytes == 0) return "0";
  const auto* unit =
      std::ranges::find_if(kSizeUnits, [&](const SizeUnit& each) { return bytes % each.bytes == 0; });
  return std::to_string(bytes / unit->bytes) + std::string(unit->name);
}

bool is_identifier(std::string_view text) {
  if (text.empty() || text.size() > 255 || !is_word_character(text.front())) return false;
  return std::ranges::all_of(text,
                             [](char c) { return is_word_character(c) || c == '-' || c == '.' || c == ':'; });
}

bool matches_glob(std::string_view pattern, std::string_view text) {
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t resume = 0;
  while (t < text.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] != '*' && pattern[p] == text[t]))) {
      ++p;
      ++t;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*')
    ++p;
  return p == pattern.size();
}

}  // namespace segue
