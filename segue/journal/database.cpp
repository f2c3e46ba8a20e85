// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/database.hpp>

#include <sqlite3.h>

#include <system_error>

namespace segue::journal::detail {

namespace {

constexpr int kBusyMilliseconds = 5000;

ErrorCode code_of(int status) {
  switch (status & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return ErrorCode::ParseError;
    case SQLITE_FULL:
    case SQLITE_NOMEM:
    case SQLITE_TOOBIG:
      return ErrorCode::ResourceExhausted;
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_AUTH:
      return ErrorCode::PermissionDenied;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_PROTOCOL:
      return ErrorCode::Unavailable;
    default:
      return ErrorCode::IoError;
  }
}

Error error_of(sqlite3* database) {
  return fail(code_of(sqlite3_extended_errcode(database)), sqlite3_errmsg(database));
}

/// The URI of the absolute path, since SQLite takes the part after two slashes for a host.
std::string uri_of(const std::filesystem::path& file, std::string_view parameters) {
  static constexpr std::string_view kHex = "0123456789ABCDEF";
  const auto path = std::filesystem::absolute(file).lexically_normal();
  std::string uri = "file:";
  for (const char c : path.native()) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '%' || c == '?' || c == '#') {
      uri += {'%', kHex[byte >> 4], kHex[byte & 15]};
    } else {
      uri += c;
    }
  }
  return uri.append(parameters);
}

Result<sqlite3*> open_file(const std::string& uri, int flags) {
  sqlite3* database = nullptr;
  const int status = sqlite3_open_v2(uri.c_str(), &database, flags | SQLITE_OPEN_URI, nullptr);
  if (status == SQLITE_OK) {
    sqlite3_extended_result_codes(database, 1);
    sqlite3_busy_timeout(database, kBusyMilliseconds);
    return database;
  }
  Error error = fail(code_of(status), sqlite3_errstr(status));
  if (database != nullptr) error = error_of(database);
  sqlite3_close(database);
  return error;
}

/// In a read-only folder SQLite cannot create the files that readers and writers share. Nobody writes the
/// journal then, so it is opened as immutable.
Result<sqlite3*> open_to_read(const std::filesystem::path& path) {
  auto database = open_file(uri_of(path, "?mode=ro"), SQLITE_OPEN_READONLY);
  if (!database) return database;
  const int status = sqlite3_exec(*database, "SELECT count(*) FROM sqlite_schema", nullptr, nullptr, nullptr);
  if (status == SQLITE_OK || code_of(status) != ErrorCode::PermissionDenied) return database;
  sqlite3_close(*database);
  return open_file(uri_of(path, "?immutable=1"), SQLITE_OPEN_READONLY);
}

/// A link may lead to any file of the user, even to one that does not exist yet and would be created.
/// SQLite's flag refuses links in the whole path, so the folder's are resolved before.
Result<sqlite3*> open_to_write(const std::filesystem::path& path) {
  std::error_code failed;
  const auto absolute = std::filesystem::absolute(path).lexically_normal();
  const auto folder = std::filesystem::canonical(absolute.parent_path(), failed);
  const auto real = failed ? absolute : folder / absolute.filename();
  if (std::filesystem::is_symlink(real, failed)) {
    return fail(ErrorCode::PermissionDenied, quote(path.native()) +
                                                 " is a symbolic link, which a journal must not be: name "
                                                 "the file itself, or remove the link");
  }
  return open_file(uri_of(real, ""), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOFOLLOW);
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

void Statement::restart() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

void Statement::bind(int place, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), place + 1, value);
}

void Statement::bind(int place, std::string_view value) {
  sqlite3_bind_text64(statement_.get(), place + 1, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
}

void Statement::bind(int place, std::optional<std::int64_t> value) {
  if (value) bind(place, *value);
}

Result<bool> Statement::next() {
  const int status = sqlite3_step(statement_.get());
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  return error_of(database_);
}

Result<void> Statement::finish() {
  while (true) {
    const auto more = next();
    if (!more) return more.error();
    if (!*more) break;
  }
  sqlite3_reset(statement_.get());
  return {};
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return text == nullptr ? std::string()
                         : std::string(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

void Database::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Result<Database> Database::open(const std::filesystem::path& path, Mode mode) {
  const auto database = mode == Mode::Read ? open_to_read(path) : open_to_write(path);
  if (!database) return database.error();
  return Database(*database);
}

Result<void> Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return error_of(database_.get());
}

Result<Statement> Database::prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int status =
      sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  if (status != SQLITE_OK) return error_of(database_.get());
  return Statement(database_.get(), statement);
}

Result<std::int64_t> Database::integer(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return statement.error();
  const auto row = statement->next();
  if (!row) return row.error();
  return *row ? statement->integer(0) : 0;
}

Result<std::string> Database::text(std::string_view sql) {
  auto statement = prepare(sql);
  if (!statement) return statement.error();
  const auto row = statement->next();
  if (!row) return row.error();
  return *row ? statement->text(0) : std::string();
}

void Database::roll_back() {
  if (sqlite3_get_autocommit(database_.get()) == 0) (void)execute("ROLLBACK");
}

}  // namespace segue::journal::detail
