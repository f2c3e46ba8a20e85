// SPDX-License-Identifier: Apache-2.0
#include <segue/web/files_folder.hpp>

#include <segue/base/sha256.hpp>
#include <segue/base/text.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace segue::web {

namespace {

constexpr std::string_view kTemporary = ".segue-studio.tmp";

/// The parts of a path, or InvalidArgument.
Result<std::vector<std::string>> parts_of(std::string_view path) {
  const Error wrong = fail(ErrorCode::InvalidArgument,
                           quote(std::string(path)) + " is not a path of a file within the robot's folder");
  if (path.find('\0') != std::string_view::npos || path.size() > 4096) return wrong;
  std::vector<std::string> parts;
  for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
    end = path.find('/', begin);
    std::string part(path.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (part.empty() || part == "." || part == "..") return wrong;
    parts.push_back(std::move(part));
  }
  return parts;
}

/// The error for the reason in errno.
Error failure(std::string_view path, const std::string& what) {
  const std::string shown = quote(std::string(path));
  if (errno == ELOOP)
    return fail(ErrorCode::PermissionDenied,
                shown + " is or leads through a symbolic link; the studio follows none");
  return system_error("cannot " + what + " " + shown, errno);
}

Result<Descriptor> open_file(const Descriptor& parent, const std::string& name, std::string_view path) {
  Descriptor file(::openat(parent.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file.valid()) return failure(path, "read");
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return failure(path, "read");
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::PermissionDenied, quote(std::string(path)) + " is not a regular file");
  return file;
}

Result<std::string> read_all(const Descriptor& file, std::string_view path) {
  std::string text(FileFolder::kLongestFile + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t got = ::read(file.get(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return failure(path, "read");
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  if (size > FileFolder::kLongestFile)
    return fail(ErrorCode::ResourceExhausted, quote(std::string(path)) +
                                                  " is too large to be edited here: more than " +
                                                  format_size(FileFolder::kLongestFile));
  text.resize(size);
  return text;
}

bool write_all(const Descriptor& file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(file.get()) == 0;
}

enum class Place : std::uint8_t { Taken, Free };

/// Moves a file, over another one where its place is Taken. 0, or the reason in errno.
int move_file(const Descriptor& from, const std::string& name, const Descriptor& to,
              const std::string& new_name, Place place) {
  const unsigned flags = place == Place::Free ? RENAME_NOREPLACE : 0;
  return ::renameat2(from.get(), name.c_str(), to.get(), new_name.c_str(), flags);
}

Error taken(std::string_view path) {
  return fail(ErrorCode::AlreadyExists,
              quote(std::string(path)) + " is there already; nothing was written over it");
}

/// A new file beside its place, which it then takes.
Result<void> put(const Descriptor& parent, const std::string& name, std::string_view text, mode_t mode,
                 std::string_view path, Place place) {
  const std::string temporary = "." + name + std::string(kTemporary);
  ::unlinkat(parent.get(), temporary.c_str(), 0);  // of a studio that was killed
  const Descriptor file(
      ::openat(parent.get(), temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file.valid()) return failure(path, "write");
  if (!write_all(file, text) || ::fchmod(file.get(), mode) != 0 ||
      move_file(parent, temporary, parent, name, place) != 0) {
    Error error = errno == EEXIST ? taken(path) : failure(path, "write");
    ::unlinkat(parent.get(), temporary.c_str(), 0);
    return error;
  }
  ::fsync(parent.get());  // the file itself is safe already
  return {};
}

Result<void> check_length(std::string_view text) {
  if (text.size() <= FileFolder::kLongestFile) return {};
  return fail(ErrorCode::ResourceExhausted,
              "the text is too long to be saved here: " + format_size(text.size()));
}

}  // namespace

Result<FileFolder> FileFolder::open(const std::filesystem::path& folder) {
  Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor.valid()) return system_error("cannot open the folder " + quote(folder.string()), errno);
  return FileFolder(std::move(descriptor));
}

Result<std::pair<Descriptor, std::string>> FileFolder::parent_of(std::string_view path) const {
  auto parts = parts_of(path);
  if (!parts) return parts.error();
  std::string name = std::move(parts->back());
  parts->pop_back();
  Descriptor parent = folder_.duplicate();
  if (!parent.valid()) return failure(path, "open");
  for (const std::string& part : *parts) {
    struct stat status {};
    const bool is_link =
        ::fstatat(parent.get(), part.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(status.st_mode);
    if (is_link) {  // openat() would say that it is not a folder
      errno = ELOOP;
      return failure(path, "open");
    }
    parent =
        Descriptor(::openat(parent.get(), part.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!parent.valid()) return failure(path, "open");
  }
  return std::pair(std::move(parent), std::move(name));
}

Result<void> FileFolder::stat(std::string_view path) const {
  const auto place = parent_of(path);
  if (!place) return place.error();
  const auto file = open_file(place->first, place->second, path);
  return file ? Result<void>() : Result<void>(file.error());
}

Result<FileFolder::Content> FileFolder::read(std::string_view path) const {
  const auto place = parent_of(path);
  if (!place) return place.error();
  const auto file = open_file(place->first, place->second, path);
  if (!file) return file.error();
  auto text = read_all(*file, path);
  if (!text) return text.error();
  std::string version = sha256(*text);
  return Content{std::move(*text), std::move(version)};
}

Result<Descriptor> FileFolder::expect(const Descriptor& parent, const std::string& name,
                                      std::string_view path, const std::string& version) {
  auto file = open_file(parent, name, path);
  if (!file && file.error().code == ErrorCode::NotFound)
    return fail(ErrorCode::InvalidState,
                quote(std::string(path)) + " was removed meanwhile; nothing was changed");
  if (!file) return file.error();
  const auto before = read_all(*file, path);
  if (!before) return before.error();
  if (sha256(*before) != version)
    return fail(ErrorCode::InvalidState,
                quote(std::string(path)) + " was changed by somebody else meanwhile; nothing was changed");
  return file;
}

Result<std::string> FileFolder::replace(std::string_view path, std::string_view text,
                                        const std::string& version) const {
  if (auto fits = check_length(text); !fits) return fits.error();
  const auto place = parent_of(path);
  if (!place) return place.error();
  const auto& [parent, name] = *place;
  const auto file = expect(parent, name, path, version);
  if (!file) return file.error();
  struct stat status {};
  if (::fstat(file->get(), &status) != 0 || ::faccessat(parent.get(), name.c_str(), W_OK, AT_EACCESS) != 0)
    return failure(path, "write");
  if (auto done = put(parent, name, text, status.st_mode & 07777U, path, Place::Taken); !done)
    return done.error();
  return sha256(text);
}

Result<std::string> FileFolder::create(std::string_view path, std::string_view text) const {
  if (auto fits = check_length(text); !fits) return fits.error();
  const auto place = parent_of(path);
  if (!place) return place.error();
  constexpr mode_t kMode = 0644;
  if (auto done = put(place->first, place->second, text, kMode, path, Place::Free); !done)
    return done.error();
  return sha256(text);
}

Result<void> FileFolder::rename(std::string_view path, std::string_view to,
                                const std::string& version) const {
  const auto from = parent_of(path);
  if (!from) return from.error();
  const auto place = parent_of(to);
  if (!place) return place.error();
  if (const auto file = expect(from->first, from->second, path, version); !file) return file.error();
  if (move_file(from->first, from->second, place->first, place->second, Place::Free) != 0)
    return errno == EEXIST ? taken(to) : failure(to, "write");
  ::fsync(place->first.get());
  ::fsync(from->first.get());
  return {};
}

Result<void> FileFolder::remove(std::string_view path, const std::string& version) const {
  const auto place = parent_of(path);
  if (!place) return place.error();
  const auto& [parent, name] = *place;
  if (const auto file = expect(parent, name, path, version); !file) return file.error();
  if (::unlinkat(parent.get(), name.c_str(), 0) != 0) return failure(path, "delete");
  ::fsync(parent.get());
  return {};
}

}  // namespace segue::web
