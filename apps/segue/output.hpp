// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/error.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

#include "command.hpp"

/// Output for users and tools: results on standard output, diagnostics and progress on standard error.
namespace segue::cli {

enum class Colour { Red, Green, Yellow, Blue, Bold, Dim };

/// `text` in that colour if standard output is a terminal and NO_COLOR is not set, else as it is.
std::string coloured(Colour colour, std::string_view text);
bool output_is_terminal();
/// How many columns the terminal of that descriptor has; as COLUMNS says, or 80, where it does not say.
std::size_t terminal_columns(int descriptor);
/// How many lines it has; 24 where it does not say.
std::size_t terminal_rows(int descriptor);
/// Begins a new page of the terminal.
inline constexpr std::string_view kClearScreen = "\x1b[H\x1b[2J";
bool errors_are_terminal();

/// Control characters are escaped as by printable(), but for what coloured() and kClearScreen wrote.
void print(std::string_view text);
void print_line(std::string_view text);  ///< with a line end, flushed
/// Writes the text, with control characters escaped, and a line end to standard error.
void print_error_line(std::string_view text);
/// Writes a file's content to standard output: unchanged into a pipe or a file, as print() to a terminal.
void print_content(std::string_view text);
/// Whether nobody reads standard output any more (its pipe or terminal is closed); waits for that at most
/// `limit`. Verbs that follow something wait with it, since what is not printed to cannot report its end.
bool reader_leaves_within(Duration limit);
/// Writes to the file, or to standard output by print_content() if `file` is empty. With --format json
/// standard output gets JSON in any case: the content as a value, {"text": ...} of a drawing, or {"file":
/// ...}. Returns the exit status.
int write_or_print(const Context& context, const std::string& file, std::string_view text);
void print_json(const type::Value& value);
/// One value a line, flushed: for streams.
void print_json_line(const type::Value& value);
/// A value for people: scalars in a line, the rest as YAML.
std::string readable(const type::Value& value);
/// A value for people in one line, whatever its size: YAML in flow style.
std::string one_line(const type::Value& value);

/// "segue: error: ..." and its causes, on standard error. In JSON also {"error": {...}} on standard output.
void print_error(const Context& context, const Error& error);
void print_note(std::string_view text);
void print_diagnostics(const Diagnostics& diagnostics);
type::Value to_value(const Diagnostics& diagnostics);

/// kUnreachable for Unavailable, else kFailed.
int exit_status(const Error& error);
/// print_error() and exit_status().
int failed(const Context& context, const Error& error);

double seconds(Duration duration);
/// The number at `key` of a map, 0 where there is none; the text there as printable(), or "";
/// the list there, or an empty one.
double number_at(const type::Value& map, std::string_view key);
std::string printable_at(const type::Value& map, std::string_view key);
const type::Value::List& list_at(const type::Value& map, std::string_view key);

/// The lines of the text, folded at blanks so that none is wider than `columns`; each with a line end.
std::string folded_lines(const std::string& text, std::size_t columns);

/// Columns as wide as their widest cell. Colours of cells do not count. To a terminal no line is wider than
/// that: texts are folded within their column, and where that would leave columns of a few letters, the table
/// goes on below with its first column again.
class Table {
 public:
  enum class Align { Left, Right };
  struct Column {
    std::string title;
    Align align = Align::Left;  ///< numbers are at the right, and are never folded
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// As wide as the terminal at most, if standard output is one.
  [[nodiscard]] std::string text() const;
  /// As wide as `limit` columns at most, unless the first column and a number take more.
  [[nodiscard]] std::string text(std::size_t limit) const;

 private:
  /// Some of the columns, side by side.
  struct Block;
  [[nodiscard]] std::vector<Block> blocks(std::size_t limit) const;
  /// Narrows the widest columns of texts until the block is as wide as `limit`, but none below `least`.
  void fold(Block& block, std::size_t limit, std::size_t least) const;
  void add_line(const Block& block, const std::vector<std::string>& cells, std::string& text) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// A line on standard error that is overwritten; only if standard error is a terminal.
class Progress {
 public:
  Progress() : active_(errors_are_terminal()) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  [[nodiscard]] bool active() const { return active_; }
  void show(std::string_view text);
  void clear();

 private:
  bool active_;
  bool shown_ = false;
};

}  // namespace segue::cli
