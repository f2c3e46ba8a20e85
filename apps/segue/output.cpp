// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include <segue/base/file.hpp>
#include <segue/type/json.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace segue::cli {

namespace {

using type::Value;

bool wants_colour() {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal != nullptr && std::string_view(terminal) == "dumb";
  return (refused == nullptr || *refused == '\0') && !dumb;
}

std::string_view code_of(Colour colour) {
  switch (colour) {
    case Colour::Red:
      return "31";
    case Colour::Green:
      return "32";
    case Colour::Yellow:
      return "33";
    case Colour::Blue:
      return "34";
    case Colour::Bold:
      return "1";
    case Colour::Dim:
      return "2";
  }
  return "0";
}

std::string painted(Colour colour, std::string_view text) {
  return fmt::format("\x1b[{}m{}\x1b[0m", code_of(colour), printable(text));
}

/// The length of the sequence of our own at the beginning of the text; 0 where there is none.
std::size_t own_sequence(std::string_view text) {
  static constexpr std::array<std::string_view, 8> kOwn = {"\x1b[0m",  "\x1b[1m",  "\x1b[2m",  "\x1b[31m",
                                                           "\x1b[32m", "\x1b[33m", "\x1b[34m", kClearScreen};
  for (const std::string_view own : kOwn) {
    if (text.starts_with(own)) return own.size();
  }
  return 0;
}

/// printable(), but for sequences of our own, which are only written to terminals.
std::string safe(std::string_view text, bool to_terminal) {
  if (!to_terminal) return printable(text);
  std::string result;
  while (!text.empty()) {
    const std::size_t own = own_sequence(text);
    result += text.substr(0, own);
    text.remove_prefix(own);
    // At least one byte, which is not a sequence of our own.
    const auto end = std::min(text.size(), text.find('\x1b', own == 0 ? 1 : 0));
    result += printable(text.substr(0, end));
    text.remove_prefix(end);
  }
  return result;
}

void put(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void end_line() {
  std::fputc('\n', stdout);
  std::fflush(stdout);
}

/// For standard error.
std::string label(Colour colour, std::string_view text) {
  return errors_are_terminal() && wants_colour() ? painted(colour, text) : std::string(text);
}

Value error_value(const Error& error) {
  Value value = Value::map({{"code", to_string(error.code)}, {"message", error.message}});
  if (!error.subject.empty()) value.as_map().set("subject", error.subject);
  if (error.where.known()) value.as_map().set("where", to_string(error.where));
  if (error.cause) value.as_map().set("cause", error_value(*error.cause));
  return value;
}

/// A word that reads the same without quotes, within braces too. YAML 1.1's "y" is one; "true" is not.
bool is_plain(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto fits = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '/' || c == '-';
  };
  if (text.empty() || !is_letter(text[0]) || !std::all_of(text.begin(), text.end(), fits)) return false;
  const auto read = type::parse_yaml(text);
  return read && read->is_string();
}

std::string flow_text(std::string_view text) {
  return is_plain(text) ? std::string(text) : printable(type::to_json(Value(text), -1));
}

std::string flow(const Value& value) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (value.is_list()) {
    for (const Value& item : value.as_list())
      add(flow(item));
    return '[' + text + ']';
  }
  if (value.is_map()) {
    for (const auto& [key, item] : value.as_map())
      add(flow_text(key) + ": " + flow(item));
    return '{' + text + '}';
  }
  return value.is_string() ? flow_text(value.as_string()) : readable(value);
}

std::string headline(const Error& error) {
  std::string text = error.where.known() ? to_string(error.where) + ": " : std::string();
  // Often the message names its subject already.
  if (!error.subject.empty() && error.message.find(error.subject) == std::string::npos) {
    text += error.subject + ": ";
  }
  return text + error.message;
}

}  // namespace

bool output_is_terminal() {
  return ::isatty(STDOUT_FILENO) == 1;
}

bool errors_are_terminal() {
  return ::isatty(STDERR_FILENO) == 1;
}

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const auto wanted = columns == nullptr ? 0 : std::strtoul(columns, nullptr, 10);
  return wanted > 0 ? wanted : 80;
}

std::size_t terminal_rows(int descriptor) {
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : 24;
}

std::string coloured(Colour colour, std::string_view text) {
  return output_is_terminal() && wants_colour() ? painted(colour, text) : std::string(text);
}

void print(std::string_view text) {
  put(safe(text, output_is_terminal()));
}

void print_line(std::string_view text) {
  print(text);
  end_line();
}

void print_error_line(std::string_view text) {
  std::fflush(stdout);
  fmt::print(stderr, "{}\n", safe(text, errors_are_terminal()));
}

void print_content(std::string_view text) {
  output_is_terminal() ? print(text) : put(text);
}

bool reader_leaves_within(Duration limit) {
  pollfd waited{STDOUT_FILENO, 0, 0};  // errors and the end are reported unasked
  const auto whole = std::chrono::floor<std::chrono::seconds>(limit);
  const timespec timeout{whole.count(), (limit - whole).count()};
  return ::ppoll(&waited, 1, &timeout, nullptr) > 0;
}

namespace {

/// The content of a file as a value; of what is not YAML or JSON, such as drawings, {"text": ...}.
Value document(std::string_view text) {
  if (auto json = type::parse_json(text)) return std::move(*json);
  auto yaml = type::parse_yaml(text);
  if (yaml && (yaml->is_map() || yaml->is_list())) return std::move(*yaml);
  return Value::map({{"text", std::string(text)}});
}

}  // namespace

int write_or_print(const Context& context, const std::string& file, std::string_view text) {
  if (file.empty()) {
    context.json() ? print_json(document(text)) : print_content(text);
    return kDone;
  }
  const auto written = write_file(file, text);
  if (!written) return failed(context, written.error());
  if (context.json()) print_json(Value::map({{"file", file}}));
  return kDone;
}

void print_json(const Value& value) {
  put(type::to_json(value));
  end_line();
}

void print_json_line(const Value& value) {
  put(type::to_json(value, -1));
  end_line();
}

std::string readable(const Value& value) {
  if (value.is_string()) return printable(value.as_string());
  std::string text = type::to_yaml(value);
  while (!text.empty() && text.back() == '\n')
    text.pop_back();
  return text;
}

std::string one_line(const Value& value) {
  return value.is_string() && value.as_string().find('\n') == std::string::npos ? printable(value.as_string())
                                                                                : flow(value);
}

void print_error(const Context& context, const Error& error) {
  if (context.json()) print_json(Value::map({{"error", error_value(error)}}));
  print_error_line(label(Colour::Red, "segue: error:") + ' ' + printable(headline(error)));
  for (const Error* cause = error.cause.get(); cause != nullptr; cause = cause->cause.get())
    print_error_line("  because: " + printable(headline(*cause)));
}

void print_note(std::string_view text) {
  print_error_line(label(Colour::Blue, "segue: note:") + ' ' + printable(text));
}

namespace {

Colour colour_of(Severity severity) {
  switch (severity) {
    case Severity::Hint:
      return Colour::Blue;
    case Severity::Warning:
      return Colour::Yellow;
    case Severity::Error:
      break;
  }
  return Colour::Red;
}

}  // namespace

void print_diagnostics(const Diagnostics& diagnostics) {
  for (const Diagnostic& item : diagnostics.items()) {
    const std::string where = item.where.known() ? to_string(item.where) + ": " : std::string();
    print_error_line(fmt::format("{}{} {} [{}]", printable(where),
                                 label(colour_of(item.severity), std::string(to_string(item.severity)) + ':'),
                                 printable(item.message), item.code));
  }
}

Value to_value(const Diagnostics& diagnostics) {
  Value::List list;
  for (const Diagnostic& item : diagnostics.items()) {
    list.push_back(Value::map({{"severity", to_string(item.severity)},
                               {"code", item.code},
                               {"message", item.message},
                               {"file", item.where.file},
                               {"line", item.where.line},
                               {"column", item.where.column}}));
  }
  return Value::map({{"ok", !diagnostics.has_errors()}, {"diagnostics", std::move(list)}});
}

int exit_status(const Error& error) {
  return error.code == ErrorCode::Unavailable ? kUnreachable : kFailed;
}

int failed(const Context& context, const Error& error) {
  print_error(context, error);
  return exit_status(error);
}

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

double number_at(const Value& map, std::string_view key) {
  const Value* value = map.find(key);
  return value != nullptr && value->is_number() ? value->as_double() : 0.0;
}

std::string printable_at(const Value& map, std::string_view key) {
  const Value* value = map.find(key);
  return value != nullptr && value->is_string() ? printable(value->as_string()) : std::string();
}

const Value::List& list_at(const Value& map, std::string_view key) {
  static const Value::List none;
  const Value* value = map.find(key);
  return value != nullptr && value->is_list() ? value->as_list() : none;
}

void Progress::show(std::string_view text) {
  if (!active_) return;
  shown_ = true;
  fmt::print(stderr, "\r\x1b[K{}", printable(text.substr(0, 100)));
  std::fflush(stderr);
}

void Progress::clear() {
  if (!shown_) return;
  shown_ = false;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace segue::cli
