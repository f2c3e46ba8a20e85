// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// SQLite with values and Results. Error codes: ParseError (the file is damaged or no database),
/// ResourceExhausted (the disk is full), PermissionDenied, Unavailable (another process holds the lock), else
/// IoError.
namespace segue::journal::detail {

/// A compiled statement. Columns and parameters are numbered from 0. Not thread safe.
class Statement {
 public:
  Statement(sqlite3* database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}

  /// Binds all parameters in order and executes to the end; for statements without rows.
  template <class... Values>
  Result<void> run(const Values&... values) {
    start(values...);
    return finish();
  }
  /// Binds all parameters in order; next() gives the rows.
  template <class... Values>
  void start(const Values&... values) {
    restart();
    int place = 0;
    (bind(place++, values), ...);
  }
  /// Whether there is another row.
  Result<bool> next();

  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] bool is_null(int column) const;

 private:
  void restart();
  Result<void> finish();
  void bind(int place, std::int64_t value);
  void bind(int place, std::string_view value);
  void bind(int place, std::optional<std::int64_t> value);

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// An open file. Not thread safe.
class Database {
 public:
  /// Write creates a missing file. Functions wait at most five seconds for a lock of another process.
  enum class Mode { Write, Read };
  static Result<Database> open(const std::filesystem::path& path, Mode mode);

  /// Statements without rows, separated by ';'.
  Result<void> execute(const std::string& sql);
  Result<Statement> prepare(std::string_view sql);
  /// The first column of the first row.
  Result<std::int64_t> integer(std::string_view sql);
  Result<std::string> text(std::string_view sql);
  /// Rolls back the transaction in progress, if there is one.
  void roll_back();

 private:
  explicit Database(sqlite3* database) : database_(database) {}
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace segue::journal::detail
