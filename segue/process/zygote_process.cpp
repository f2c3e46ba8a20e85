// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/process/assignment.hpp>
#include <segue/process/zygote.hpp>
#include <segue/process/zygote_message.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace segue::process::detail {

namespace {

constexpr std::string_view kLogSource = "zygote";

std::size_t threads_of_this_process() {
  std::error_code failed;
  const std::filesystem::directory_iterator tasks("/proc/self/task", failed);
  return failed ? 1 : static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// Libraries that cannot be loaded are only logged: the process that needs one fails with a message of its
/// own. False where a library has started threads, since these would be missing in every child.
bool preload_all(CommandLine command, const Preload& preload) {
  for (int i = 2; i + 1 < command.count; ++i) {
    const auto loaded = preload(command.words[i]);
    if (!loaded) log(LogLevel::Warning, kLogSource, "not preloaded: " + to_string(loaded.error()));
  }
  if (threads_of_this_process() == 1) return true;
  log(LogLevel::Error, kLogSource,
      "a component library starts threads when it is loaded, so it cannot be preloaded; leave it out of the "
      "zygote's libraries");
  return false;
}

/// Overwrites the arguments of main(), which lie one after the other in memory: `ps` shows what is there.
void set_command(CommandLine command, const char* title) {
  char* const begin = command.words[0];
  const char* const last = command.words[command.count - 1];
  const auto room = static_cast<std::size_t>(last + std::strlen(last) + 1 - begin);
  std::string text(kDeploymentProgram);
  text.push_back('\0');
  text.append(title, ::strnlen(title, kTitleSize - 1));
  std::memset(begin, 0, room);
  std::memcpy(begin, text.data(), std::min(text.size(), room - 1));
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

}  // namespace

int run_zygote(CommandLine command, const Preload& preload, const std::function<int()>& deployment_process) {
  ::unsetenv("LD_BIND_NOW");
  Descriptor socket = above_inherited(kAssignment);
  if (!socket.valid()) return kWrongUse;
  occupy_inherited();
  if (!preload_all(command, preload)) return kNotPermitted;
  for (;;) {
    ZygoteRequest request;
    std::vector<Descriptor> handed;
    if (!receive_message(socket.get(), &request, sizeof request, handed)) return kOrderly;
    ZygoteReply reply;
    if (request.kind == ZygoteRequestKind::Reap) {
      reply = reap_one(request.pid);
    } else if (handed.size() != kHandedDescriptors) {
      reply.error = EBADF;
    } else {
      const pid_t pid = ::fork();
      if (pid == 0) {
        ::setpgid(0, 0);
        socket = Descriptor();
        if (!arrange(handed)) return kWrongUse;
        handed.clear();
        set_command(command, request.title.data());
        return deployment_process();
      }
      if (pid > 0) ::setpgid(pid, pid);
      reply = {pid < 0 ? 0 : pid, pid < 0 ? errno : 0, 0, 0};
    }
    if (!send_message(socket.get(), &reply, sizeof reply, {})) return kOrderly;
  }
}

}  // namespace segue::process::detail
