// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/zygote.hpp>
#include <segue/process_server/zygote_message.hpp>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace segue::process_server::detail {

namespace {

constexpr std::string_view kLogSource = "zygote";
constexpr const char* kSpareTitle = "spare";

std::size_t threads_of_this_process() {
  std::error_code failed;
  const std::filesystem::directory_iterator tasks("/proc/self/task", failed);
  return failed ? 1 : static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// Libraries that cannot be loaded are only logged: the process that needs one fails with a message of its
/// own. False where a library has started threads, since these would be missing in every child.
bool preload_all(CommandLine command, const ZygoteWork& work) {
  for (int i = 2; i + 1 < command.count; ++i) {
    const auto loaded = work.preload(command.words[i]);
    if (!loaded) log(LogLevel::Warning, kLogSource, "not preloaded: " + to_string(loaded.error()));
  }
  if (threads_of_this_process() == 1) return true;
  log(LogLevel::Error, kLogSource,
      "a component library starts threads when it is loaded, so it cannot be preloaded; leave it out of the "
      "zygote's libraries");
  return false;
}

/// The arguments of main(), which lie one after the other in memory: `ps` shows what is there.
std::span<char> room_of(CommandLine command) {
  char* const begin = command.words[0];
  const char* const last = command.words[command.count - 1];
  return {begin, static_cast<std::size_t>(last + std::strlen(last) + 1 - begin)};
}

void set_command(std::span<char> room, const char* title) {
  std::string text(kDeploymentProgram);
  text.push_back('\0');
  text.append(title, ::strnlen(title, kTitleSize - 1));
  std::memset(room.data(), 0, room.size());
  std::memcpy(room.data(), text.data(), std::min(text.size(), room.size() - 1));
}

/// Gives the descriptors the numbers that the program expects (Inherited). They all have higher numbers
/// before, so none is overwritten too early.
bool arrange(const std::vector<Descriptor>& handed) {
  const std::pair<int, int> places[] = {{0, STDOUT_FILENO}, {0, STDERR_FILENO}, {1, kAssignment},
                                        {2, kListener},     {3, kLock},         {4, kOutputChanges}};
  return std::all_of(std::begin(places), std::end(places), [&](const auto& place) {
    return ::dup2(handed[static_cast<std::size_t>(place.first)].get(), place.second) >= 0;
  });
}

ZygoteReply reap_one(pid_t pid) {
  siginfo_t ended{};
  ZygoteReply reply;
  if (pid <= 0 || ::waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG) != 0) {
    reply.error = errno;
    return reply;
  }
  return {ended.si_pid, 0, ended.si_code, ended.si_status};
}

/// A duplicate beyond the numbers that children need for the descriptors that they inherit.
Descriptor above_inherited(int descriptor) {
  return Descriptor(::fcntl(descriptor, F_DUPFD_CLOEXEC, static_cast<int>(kFirstFree)));
}

/// Occupies the numbers that children need, so that no descriptor that is received later gets one of them.
void occupy_inherited() {
  Descriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  null = above_inherited(null.get());
  for (const int number : {int{kAssignment}, int{kListener}, int{kLock}, int{kOutputChanges}})
    ::dup3(null.get(), number, O_CLOEXEC);
}

/// A child that waits for the process that it will be; when nobody has the other end of its socket any more,
/// it ends.
struct Spare {
  pid_t pid = 0;  ///< 0: there is none
  Descriptor socket;
};

/// The zygote while it serves.
class ZygoteProcess {
 public:
  ZygoteProcess(std::span<char> command, const ZygoteWork& work, Descriptor socket)
      : command_(command), work_(work), socket_(std::move(socket)) {}

  /// The exit status: of the zygote, or of a child in that child.
  int serve() {
    for (;;) {
      if (spare_.pid == 0) {
        if (const auto child = make_spare()) return *child;
      }
      ZygoteRequest request;
      std::vector<Descriptor> handed;
      if (!receive_message(socket_.get(), &request, sizeof request, handed)) return kOrderly;
      const ZygoteReply reply =
          request.kind == ZygoteRequestKind::Reap ? reap_one(request.pid) : launch(request, handed);
      if (!send_message(socket_.get(), &reply, sizeof reply, {})) return kOrderly;
    }
  }

 private:
  /// The exit status in the child, nothing in the zygote.
  std::optional<int> make_spare() {
    std::array<int, 2> pair{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) return no_spare();
    Descriptor ours(pair[0]);
    Descriptor theirs(pair[1]);
    const pid_t pid = ::fork();
    if (pid < 0) return no_spare();
    if (pid == 0) {
      ::setpgid(0, 0);
      ours = Descriptor();
      socket_ = Descriptor();
      return be_child(std::move(theirs));
    }
    ::setpgid(pid, pid);
    spare_ = {pid, std::move(ours)};
    return std::nullopt;
  }
  std::optional<int> no_spare() {
    error_ = errno;
    return std::nullopt;
  }

  [[nodiscard]] int be_child(Descriptor socket) const {
    set_command(command_, kSpareTitle);
    work_.prepare();
    ZygoteRequest request;
    std::vector<Descriptor> handed;
    if (!receive_message(socket.get(), &request, sizeof request, handed)) return kOrderly;
    if (handed.size() != kHandedDescriptors || !arrange(handed)) return kWrongUse;
    handed.clear();
    socket = Descriptor();
    set_command(command_, request.title.data());
    return work_.deploy();
  }

  /// The spare becomes the process that is asked for. Where it has died meanwhile, the process server starts
  /// that process by other means.
  ZygoteReply launch(const ZygoteRequest& request, const std::vector<Descriptor>& handed) {
    const Spare chosen = std::exchange(spare_, Spare());
    if (chosen.pid == 0) return {0, error_, 0, 0};
    std::vector<int> numbers;
    for (const Descriptor& descriptor : handed)
      numbers.push_back(descriptor.get());
    const bool fits = numbers.size() == kHandedDescriptors;
    if (fits && send_message(chosen.socket.get(), &request, sizeof request, numbers)) {
      return {chosen.pid, 0, 0, 0};
    }
    const int reason = fits ? errno : EBADF;
    ::kill(chosen.pid, SIGKILL);
    ::waitpid(chosen.pid, nullptr, 0);
    return {0, reason, 0, 0};
  }

  const std::span<char> command_;
  const ZygoteWork& work_;
  Descriptor socket_;  ///< to the process server
  Spare spare_;
  int error_ = 0;  ///< why there is no spare
};

}  // namespace

int run_zygote(CommandLine command, const ZygoteWork& work) {
  ::unsetenv("LD_BIND_NOW");
  Descriptor socket = above_inherited(kAssignment);
  if (!socket.valid()) return kWrongUse;
  occupy_inherited();
  if (!preload_all(command, work)) return kNotPermitted;
  return ZygoteProcess(room_of(command), work, std::move(socket)).serve();
}

}  // namespace segue::process_server::detail
