// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/deploy/pidfd.hpp>
#include <segue/deploy/process_place.hpp>
#include <segue/deploy/system_error.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <string_view>

namespace segue::deploy::detail {

namespace {

namespace fs = std::filesystem;

constexpr int kBacklog = 64;
constexpr mode_t kOwnerOnly = 0600;
constexpr int kAttempts = 100;
/// Records are padded to this size, so that a full disk lets them be overwritten.
constexpr std::size_t kRecordSize = 128;
constexpr std::string_view kProgram = "segue-deployment";

fs::path lock_path(const fs::path& socket) {
  return fs::path(socket) += ".lock";
}

Result<sockaddr_un> address_of(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.size() >= sizeof address.sun_path) {
    return fail(ErrorCode::InvalidArgument,
                "the path of the socket " + quote(text) + " is longer than the " +
                    std::to_string(sizeof address.sun_path - 1) +
                    " bytes that the system allows; give robot or process a shorter name, or set "
                    "XDG_RUNTIME_DIR to a folder with a shorter path");
  }
  std::copy(text.begin(), text.end(), address.sun_path);
  return address;
}

bool is_file_at(int descriptor, const fs::path& path) {
  struct stat mine {};
  struct stat there {};
  return ::fstat(descriptor, &mine) == 0 && ::stat(path.c_str(), &there) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

/// Nothing where somebody else has the lock. A lock whose file was removed while we waited for it is no
/// lock: then again.
Result<std::optional<Descriptor>> try_lock(const fs::path& path) {
  for (int i = 0; i < kAttempts; ++i) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly));
    if (!file.valid()) return system_error("cannot open the lock " + quote(path.native()), errno);
    if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return std::optional<Descriptor>{};
      return system_error("cannot lock " + quote(path.native()), errno);
    }
    if (is_file_at(file.get(), path)) return std::optional<Descriptor>(std::move(file));
  }
  return fail(ErrorCode::Unavailable, "the lock " + quote(path.native()) + " changes hands all the time");
}

Result<Descriptor> bind_socket(const fs::path& path) {
  const auto address = address_of(path);
  if (!address) return address.error();
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.valid()) return system_error("cannot make a socket", errno);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return system_error("cannot remove the stale socket " + quote(path.native()), errno);
  }
  const auto* raw = reinterpret_cast<const sockaddr*>(&*address);
  if (::bind(socket.get(), raw, sizeof *address) != 0) {
    return system_error("cannot make the socket " + quote(path.native()), errno);
  }
  // Nobody can connect before listen(), so the mode is right before it matters.
  if (::chmod(path.c_str(), kOwnerOnly) != 0 || ::listen(socket.get(), kBacklog) != 0) {
    const int reason = errno;
    ::unlink(path.c_str());
    return system_error("cannot listen on " + quote(path.native()), reason);
  }
  return socket;
}

/// "pid 12\nsoftware 0.1.0\n"; zeros follow.
std::optional<LockRecord> read_record(const fs::path& lock) {
  const Descriptor file(::open(lock.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  std::array<char, kRecordSize> buffer{};
  const ssize_t size = file.valid() ? ::pread(file.get(), buffer.data(), buffer.size(), 0) : -1;
  constexpr std::string_view kPid = "pid ";
  constexpr std::string_view kSoftware = "\nsoftware ";
  std::string_view text(buffer.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
  if (!text.starts_with(kPid)) return std::nullopt;
  text.remove_prefix(kPid.size());
  LockRecord record;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), record.pid);
  if (status != std::errc{} || record.pid < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.starts_with(kSoftware)) return std::nullopt;
  text.remove_prefix(kSoftware.size());
  record.software = text.substr(0, std::min(text.find('\n'), text.size()));
  return record;
}

/// The first two words of its command line.
std::string command_of(int pid) {
  const std::string path = "/proc/" + std::to_string(pid) + "/cmdline";
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 1024> buffer{};
  const ssize_t size = file.valid() ? ::read(file.get(), buffer.data(), buffer.size()) : 0;
  const std::string_view text(buffer.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
  const auto first = std::min(text.find('\0'), text.size());
  const auto second = std::min(text.find('\0', std::min(first + 1, text.size())), text.size());
  std::string command(text.substr(0, second));
  std::replace(command.begin(), command.end(), '\0', ' ');
  return command;
}

bool is_ours(int pid) {
  struct stat status {};
  return ::stat(("/proc/" + std::to_string(pid)).c_str(), &status) == 0 && status.st_uid == ::geteuid();
}

bool has_ended(int pidfd) {
  pollfd waited{pidfd, POLLIN, 0};
  return ::poll(&waited, 1, 0) != 0;
}

}  // namespace

bool write_record(int lock, const LockRecord& record) {
  std::string text = "pid " + std::to_string(record.pid) + "\nsoftware " + record.software + "\n";
  text.resize(kRecordSize, '\0');
  return ::pwrite(lock, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

ProcessPlace::ProcessPlace(fs::path path, Descriptor lock, Descriptor socket)
    : path_(std::move(path)), lock_(std::move(lock)), socket_(std::move(socket)) {}

Result<ProcessPlace> ProcessPlace::claim(const fs::path& socket) {
  if (const auto address = address_of(socket); !address) return address.error();
  auto lock = try_lock(lock_path(socket));
  if (!lock) return lock.error();
  if (!lock->has_value()) {
    return fail(ErrorCode::AlreadyExists, "a process that holds " + quote(socket.native()) + " runs already");
  }
  if (!write_record((*lock)->get(), {})) {
    const int reason = errno;
    ::unlink(lock_path(socket).c_str());
    return system_error("cannot write the lock " + quote(lock_path(socket).native()), reason);
  }
  auto bound = bind_socket(socket);
  if (!bound) {
    ::unlink(lock_path(socket).c_str());
    return bound.error();
  }
  return ProcessPlace(socket, std::move(**lock), std::move(*bound));
}

ProcessPlace::~ProcessPlace() {
  if (kept_ || !lock_.valid()) return;  // handed over, or moved from
  ::unlink(path_.c_str());
  ::unlink(lock_path(path_).c_str());
}

bool remove_if_stale(const fs::path& socket) {
  const auto lock = try_lock(lock_path(socket));
  if (!lock || !lock->has_value()) return false;
  ::unlink(socket.c_str());
  ::unlink(lock_path(socket).c_str());
  return true;
}

Result<std::optional<FoundProcess>> find_process(const fs::path& socket, const std::string& title) {
  std::error_code ignored;
  if (!fs::exists(socket, ignored) || remove_if_stale(socket)) return std::optional<FoundProcess>{};
  const auto record = read_record(lock_path(socket));
  if (!record || record->pid == 0) {
    return fail(ErrorCode::Unavailable, "process " + title + " is only just starting");
  }
  // From here on the number means one process only; what is read of it is its own if it still lives then.
  FoundProcess found{record->pid, Descriptor(open_pidfd(record->pid)), record->software};
  if (!found.pidfd.valid()) {
    if (errno == ESRCH) return std::optional<FoundProcess>{};
    return system_error("cannot watch process " + title, errno);
  }
  const bool fits = is_ours(found.pid) && command_of(found.pid) == std::string(kProgram) + ' ' + title;
  if (!fits || has_ended(found.pidfd.get())) return std::optional<FoundProcess>{};
  return std::optional<FoundProcess>(std::move(found));
}

std::string process_title(const std::string& robot, const fs::path& socket) {
  return robot + '/' + socket.stem().string();
}

}  // namespace segue::deploy::detail
