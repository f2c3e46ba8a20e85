// SPDX-License-Identifier: Apache-2.0
#include <segue/base/fnv1a.hpp>
#include <segue/mission_engine/run_journal_file.hpp>

#include <segue/base/file.hpp>
#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace segue::mission {

namespace {

using type::Value;
using type::ValueMap;

/// 1 had no checksums.
constexpr std::uint64_t kVersion = 2;
constexpr std::string_view kVersionKey = "segue_mission_run";
constexpr std::string_view kChecksumKey = ",\"checksum\":\"";
constexpr std::string_view kChecksumEnd = "\"}";
constexpr std::size_t kDigits = 16;

Error not_a_journal(const std::string& why) {
  return fail(ErrorCode::ParseError, "this is not a journal of a mission run: " + why);
}

std::string hexadecimal(std::uint64_t number) {
  char text[kDigits + 1];
  std::snprintf(text, sizeof text, "%016" PRIx64, number);
  return text;
}

/// The line with its checksum, which also covers what has the checksum `before`, and a line feed.
std::string with_checksum(const ValueMap& fields, std::uint64_t before, std::uint64_t& checksum) {
  std::string text = type::to_json(fields, -1);
  text.pop_back();
  checksum = fnv1a(text, before);
  return text.append(kChecksumKey).append(hexadecimal(checksum)).append(kChecksumEnd) += '\n';
}

/// The checksum at the end of a line, which has no line feed; nothing if there is none.
std::optional<std::string> stated_checksum(std::string_view line) {
  const std::size_t tail = kChecksumKey.size() + kDigits + kChecksumEnd.size();
  if (line.size() <= tail || !line.ends_with(kChecksumEnd)) return std::nullopt;
  const std::string_view end = line.substr(line.size() - tail);
  if (!end.starts_with(kChecksumKey)) return std::nullopt;
  return std::string(end.substr(kChecksumKey.size(), kDigits));
}

/// A line whose checksum is right.
struct GoodLine {
  Value fields;
  std::uint64_t checksum = 0;
  [[nodiscard]] std::uint64_t number() const {
    const Value* number = fields.find("entry");
    return number == nullptr || !number->is_integer() ? 0 : number->as_uint();
  }
  [[nodiscard]] bool follows(std::uint64_t checksum_before) const {
    const Value* after = fields.find("after");
    return after != nullptr && *after == Value(hexadecimal(checksum_before));
  }
};

std::optional<GoodLine> good_line(std::string_view line, std::uint64_t before = kFnvBasis) {
  const auto stated = stated_checksum(line);
  if (!stated) return std::nullopt;
  const std::size_t tail = kChecksumKey.size() + kDigits + kChecksumEnd.size();
  const std::uint64_t checksum = fnv1a(line.substr(0, line.size() - tail), before);
  if (hexadecimal(checksum) != *stated) return std::nullopt;
  auto fields = type::parse_json(line);
  if (!fields || !fields->is_map()) return std::nullopt;
  return GoodLine{std::move(*fields), checksum};
}

/// The next line without its line feed; nothing if there is none that is whole.
std::optional<std::string_view> next_line(std::string_view& text) {
  const auto end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

/// Whether a line that is whole and undamaged comes yet.
bool has_good_line(std::string_view text) {
  while (const auto line = next_line(text)) {
    if (good_line(*line)) return true;
  }
  return false;
}

std::string entries_text(std::uint64_t first, std::uint64_t last) {
  return first == last ? "entry " + std::to_string(first) + " is missing"
                       : "entries " + std::to_string(first) + " to " + std::to_string(last) + " are missing";
}

/// Why an entry that is undamaged does not continue the one numbered `last`.
std::string why_not_next(const GoodLine& line, std::uint64_t last) {
  const std::uint64_t number = line.number();
  if (number > last + 1) return entries_text(last + 1, number - 1);
  if (number <= last)
    return "entry " + std::to_string(number) + " stands behind entry " + std::to_string(last);
  return "entry " + std::to_string(number) + " is one of another run";
}

Result<Descriptor> open_locked(const std::filesystem::path& path, int flags) {
  Descriptor file(::open(path.c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0600));
  std::error_code ignored;
  if (!file.valid() && (errno == ELOOP || errno == EEXIST) && std::filesystem::is_symlink(path, ignored)) {
    return fail(ErrorCode::PermissionDenied, quote(path.string()) +
                                                 " is a symbolic link, which a journal must not be: name "
                                                 "the file itself, or remove the link");
  }
  if (!file.valid() && errno == EEXIST) {
    return fail(ErrorCode::AlreadyExists,
                quote(path.string()) + " already exists; resume its run, or name another file");
  }
  if (!file.valid()) return system_error("cannot open " + quote(path.string()), errno);
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0)
    return fail(ErrorCode::InvalidState, "another run is writing " + quote(path.string()));
  return file;
}

bool write_at(const Descriptor& file, std::size_t place, std::string_view text) {
  while (!text.empty()) {
    const auto written = ::pwrite(file.get(), text.data(), text.size(), static_cast<off_t>(place));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    place += static_cast<std::size_t>(written);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

/// The second line, which always has the same length.
std::string RunJournalFile::second_line() const {
  std::uint64_t checksum = 0;
  ValueMap fields;
  fields.append("synced", hexadecimal(synced_));
  return with_checksum(fields, run_, checksum);
}

Result<std::unique_ptr<RunJournalFile>> RunJournalFile::create(const std::filesystem::path& path,
                                                               const ValueMap& first, Tell tell) {
  auto opened = open_locked(path, O_CREAT | O_EXCL);
  if (!opened) return opened.error();
  std::unique_ptr<RunJournalFile> file(new RunJournalFile(std::move(*opened), std::move(tell)));
  const Lock lock(file->mutex_);
  ValueMap fields;
  fields.append(std::string(kVersionKey), kVersion);
  fields.append("id", hexadecimal(random_number()));  // runs that do the same have other checksums, too
  for (const auto& [key, value] : first)
    fields.append(key, value);
  std::string text = with_checksum(fields, kFnvBasis, file->run_);
  file->last_ = file->run_;
  file->second_at_ = text.size();
  text += file->second_line();
  if (!write_at(file->file_, 0, text) || ::fdatasync(file->file_.get()) != 0) {
    const int reason = errno;
    ::unlink(path.c_str());
    return system_error("cannot write to " + quote(path.string()), reason);
  }
  file->length_ = text.size();
  return file;
}

Result<std::unique_ptr<RunJournalFile>> RunJournalFile::open(const std::filesystem::path& path, Tell tell) {
  auto opened = open_locked(path, 0);
  if (!opened) return opened.error();
  const auto text = read_file(path);
  if (!text) return text.error();
  std::unique_ptr<RunJournalFile> file(new RunJournalFile(std::move(*opened), std::move(tell)));
  const Lock lock(file->mutex_);
  if (auto done = file->read(*text); !done) return done.error();
  return file;
}

Result<void> RunJournalFile::read(std::string_view text) {
  const std::size_t size = text.size();
  if (text.empty()) return not_a_journal("it is empty, as a run leaves it that could not write it");
  const auto first = next_line(text);
  const auto plain = first ? type::parse_json(*first) : Result<Value>(not_a_journal(""));
  const Value* version = plain ? plain->find(kVersionKey) : nullptr;
  if (version == nullptr) return not_a_journal("its first line does not identify one");
  if (*version != Value(kVersion)) {
    return fail(ErrorCode::ParseError,
                "this journal was written by another version of Segue, in a form that this one does not "
                "continue; start a new run");
  }
  auto good = good_line(*first);
  if (!good) return fail(ErrorCode::ParseError, "the first line of the journal is damaged; start a new run");
  run_ = last_ = good->checksum;
  contents_.first = std::move(good->fields);
  second_at_ = size - text.size();
  const auto second = next_line(text);
  const auto mark = second ? good_line(*second, run_) : std::nullopt;
  const Value* synced = mark ? mark->fields.find("synced") : nullptr;
  if (synced == nullptr || !synced->is_string())
    return fail(ErrorCode::ParseError, "the second line of the journal is damaged; start a new run");
  synced_ = std::strtoull(synced->as_string().c_str(), nullptr, 16);
  length_ = size - text.size();
  read_entries(text);
  return {};
}

void RunJournalFile::read_entries(std::string_view text) {
  const auto refuse = [this](const std::string& why) SEGUE_REQUIRES(mutex_) { contents_.refusal = why; };
  while (!text.empty()) {
    const std::string_view rest = text;
    const auto line = next_line(text);
    auto good = line ? good_line(*line) : std::nullopt;
    if (!good) {
      if (line && has_good_line(text))
        return refuse("line " + std::to_string(entries_ + 3) + " is damaged, and lines behind it are not");
      contents_.cut = static_cast<std::size_t>(std::count(rest.begin(), rest.end(), '\n')) +
                      (rest.ends_with('\n') ? 0 : 1);
      break;
    }
    if (good->number() != entries_ + 1 || !good->follows(last_)) return refuse(why_not_next(*good, entries_));
    ++entries_;
    last_ = good->checksum;
    length_ += line->size() + 1;
    contents_.entries.push_back(std::move(good->fields));
  }
  if (synced_ > entries_) refuse(entries_text(entries_ + 1, synced_) + " at its end");
}

RunJournalFile::Contents RunJournalFile::take_contents() {
  const Lock lock(mutex_);
  return std::move(contents_);
}

Result<void> RunJournalFile::continue_after_contents() {
  const Lock lock(mutex_);
  if (::ftruncate(file_.get(), static_cast<off_t>(length_)) == 0) return {};
  return system_error("cannot write the journal", errno);
}

void RunJournalFile::add(const ValueMap& entry, bool durable) {
  const Lock lock(mutex_);
  if (!file_.valid()) return;
  ValueMap fields;
  fields.append("entry", ++entries_);
  fields.append("after", hexadecimal(last_));
  for (const auto& [key, value] : entry)
    fields.append(key, value);
  pending_ += with_checksum(fields, kFnvBasis, last_);
  const bool is_written = write_pending();
  if (!is_written) fell_behind(errno);
  if (durable) {
    synced_ = entries_;
    if (!write_synced()) return;
  }
  if (is_written && std::exchange(is_behind_, false) && tell_) tell_("the run's journal is complete again");
}

bool RunJournalFile::write_pending() {
  if (!write_at(file_, length_, pending_)) return false;
  length_ += pending_.size();
  pending_.clear();
  return true;
}

/// False: the file has been given up, or it is not known whether it has reached the disk.
bool RunJournalFile::write_synced() {
  if (!write_at(file_, second_at_, second_line())) {
    give_up(errno);
    return false;
  }
  if (::fdatasync(file_.get()) == 0) return true;
  fell_behind(errno);
  return false;
}

void RunJournalFile::fell_behind(int reason) {
  if (std::exchange(is_behind_, true) || !tell_) return;
  tell_(system_error("the run's journal cannot be written; until it can be, a run that is interrupted may "
                     "not be resumed",
                     reason)
            .message);
}

void RunJournalFile::give_up(int reason) {
  (void)::ftruncate(file_.get(), 0);
  file_ = Descriptor();
  if (tell_)
    tell_(system_error("this run can no longer be resumed: its journal cannot be written", reason).message);
}

void RunJournalFile::close() {
  const Lock lock(mutex_);
  if (file_.valid()) (void)write_pending();
  file_ = Descriptor();
}

std::string RunJournalFile::run() {
  const Lock lock(mutex_);
  return std::to_string(run_);
}

}  // namespace segue::mission
