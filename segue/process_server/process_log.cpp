// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/process_log.hpp>

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <utility>
#include <vector>

namespace segue::process_server {

namespace {

namespace fs = std::filesystem;

constexpr int kMostOlder = 1000;
constexpr std::size_t kChunk = std::size_t{64} << 10;

fs::path older(const fs::path& log, int number) {
  return fs::path(log) += '.' + std::to_string(number);
}

/// A file of a log that can be read.
struct LogFile {
  Descriptor file;
  std::uint64_t inode = 0;
  std::uint64_t size = 0;

  [[nodiscard]] std::string read(std::uint64_t from, std::size_t most) const {
    std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(size - std::min(size, from), most)),
                     '\0');
    const ssize_t read = ::pread(file.get(), text.data(), text.size(), static_cast<off_t>(from));
    text.resize(read < 0 ? 0 : static_cast<std::size_t>(read));
    return text;
  }
  /// The last `most` bytes.
  [[nodiscard]] std::string end(std::size_t most) const {
    return read(size - std::min<std::uint64_t>(size, most), most);
  }
};

std::optional<LogFile> open_to_read(const fs::path& file) {
  LogFile opened{Descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK))};
  struct stat status {};
  if (!opened.file.valid() || ::fstat(opened.file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  opened.inode = status.st_ino;
  opened.size = static_cast<std::uint64_t>(status.st_size);
  return opened;
}

Error no_log(const fs::path& log) {
  return fail(ErrorCode::NotFound, "there is no log " + quote(log.native()));
}

/// Where the last `lines` lines of the text begin; npos where it has fewer.
std::size_t begin_of_last(const std::string& text, std::size_t lines) {
  std::size_t at = text.size();
  if (lines == 0) return at;
  if (at > 0 && text[at - 1] == '\n') --at;
  for (std::size_t i = 0; i < lines; ++i) {
    if (at == 0) return std::string::npos;
    at = text.rfind('\n', at - 1);
    if (at == std::string::npos) return at;
  }
  return at + 1;
}

bool same_file(int descriptor, const fs::path& file) {
  struct stat mine {};
  struct stat there {};
  return ::fstat(descriptor, &mine) == 0 && ::stat(file.c_str(), &there) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

}  // namespace

Result<Descriptor> open_log(const fs::path& log) {
  Descriptor file(::open(log.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file.valid()) return system_error("cannot open the log " + quote(log.native()), errno);
  return file;
}

Result<Descriptor> open_output_changes() {
  Descriptor changes(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK));
  if (!changes.valid()) changes = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!changes.valid()) return system_error("cannot watch a log", errno);
  return changes;
}

OutputLog::OutputLog(fs::path log, std::size_t size, int files, Descriptor changes)
    : log_(std::move(log)), size_(size), files_(files), changes_(std::move(changes)) {
  watch();
}

/// For one change: a process that prints much is not woken for each line.
void OutputLog::watch() {
  if (changes_.valid()) ::inotify_add_watch(changes_.get(), log_.c_str(), IN_MODIFY | IN_ONESHOT);
}

void OutputLog::rotate() {
  std::array<char, 4096> events{};
  while (changes_.valid() && ::read(changes_.get(), events.data(), events.size()) > 0) {
  }
  if (is_too_large()) begin_new_file();
  watch();
}

bool OutputLog::is_too_large() const {
  struct stat status {};
  return ::fstat(STDOUT_FILENO, &status) == 0 && S_ISREG(status.st_mode) &&
         static_cast<std::size_t>(status.st_size) > size_ && same_file(STDOUT_FILENO, log_);
}

void OutputLog::begin_new_file() const {
  for (int number = std::min(files_, kMostOlder) - 1; number > 0; --number)
    ::rename(older(log_, number).c_str(), older(log_, number + 1).c_str());
  const int done = files_ > 0 ? ::rename(log_.c_str(), older(log_, 1).c_str()) : ::unlink(log_.c_str());
  if (done != 0) return;
  const auto fresh = open_log(log_);
  if (!fresh) return;
  ::dup2(fresh->get(), STDOUT_FILENO);
  ::dup2(fresh->get(), STDERR_FILENO);
}

Result<LogPart> log_tail(const fs::path& log, std::size_t lines, std::size_t most) {
  const auto newest = open_to_read(log);
  if (!newest) return no_log(log);
  LogPart part{newest->end(most), {newest->inode, newest->size}};
  std::string& text = part.text;
  for (int number = 1; number <= kMostOlder && text.size() < most; ++number) {
    if (begin_of_last(text, lines) != std::string::npos) break;
    const auto before = open_to_read(older(log, number));
    if (!before || before->size == 0) break;
    text.insert(0, before->end(most - text.size()));
  }
  const auto begin = begin_of_last(text, lines);
  if (begin != std::string::npos) text.erase(0, begin);
  return part;
}

Result<LogPart> log_after(const fs::path& log, const LogPosition& position) {
  auto newer = open_to_read(log);
  if (!newer) return no_log(log);
  const auto read_from = [](const LogFile& file, std::uint64_t offset) {
    std::string text = file.read(offset, kChunk);
    const std::uint64_t end = offset + text.size();
    return LogPart{std::move(text), {file.inode, end}};
  };
  if (newer->inode == position.file && position.offset <= newer->size) {
    return read_from(*newer, position.offset);
  }
  for (int number = 1; number <= kMostOlder; ++number) {
    auto file = open_to_read(older(log, number));
    if (!file) break;
    if (file->inode == position.file && position.offset <= file->size) {
      return position.offset < file->size ? read_from(*file, position.offset) : read_from(*newer, 0);
    }
    newer = std::move(file);
  }
  const auto newest = open_to_read(log);
  return newest ? Result<LogPart>(read_from(*newest, 0)) : Result<LogPart>(no_log(log));
}

}  // namespace segue::process_server
