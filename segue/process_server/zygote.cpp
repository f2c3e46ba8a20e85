// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/process_server/os_process.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/zygote.hpp>
#include <segue/process_server/zygote_message.hpp>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace segue::process_server::detail {

struct Zygote::Request : ZygoteRequest {};
struct Zygote::Reply : ZygoteReply {};

namespace {

/// A zygote that takes longer counts as hanging. It may still be loading libraries at the first request.
constexpr timeval kAnswerTime{5, 0};

}  // namespace

Result<std::unique_ptr<Zygote>> Zygote::start(const std::filesystem::path& program,
                                              const std::vector<std::string>& libraries,
                                              const std::filesystem::path& log) {
  std::array<int, 2> pair{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    return system_error("cannot make a socket for a zygote", errno);
  }
  Descriptor ours(pair[0]);
  const Descriptor theirs(pair[1]);
  for (const int option : {SO_RCVTIMEO, SO_SNDTIMEO})
    ::setsockopt(ours.get(), SOL_SOCKET, option, &kAnswerTime, sizeof kAnswerTime);
  std::vector<std::string> words = {std::string(kZygoteOption)};
  words.insert(words.end(), libraries.begin(), libraries.end());
  // Reserves room that its children overwrite with their own command lines.
  words.emplace_back(2 * kTitleSize, ' ');
  const auto output = open_log(log);
  HandedOver files;
  files.output = output ? output->get() : -1;
  files.assignment = theirs.get();
  const auto pid = spawn(program, words, {{"LD_BIND_NOW", "1"}}, files);
  if (!pid) return pid.error();
  return std::unique_ptr<Zygote>(new Zygote(std::move(ours), *pid));
}

Zygote::~Zygote() {
  const Lock lock(mutex_);
  end();
}

/// Ends the zygote: afterwards it certainly forks no more.
void Zygote::end() {
  if (!socket_.valid()) return;
  socket_ = Descriptor();
  ::kill(pid_, SIGKILL);
  reap_child(pid_);
}

std::optional<Zygote::Reply> Zygote::ask(const Request& request, std::span<const int> descriptors) {
  if (!socket_.valid()) return std::nullopt;
  Reply reply;
  std::vector<Descriptor> none;
  const ZygoteRequest& sent = request;
  ZygoteReply& received = reply;
  if (send_message(socket_.get(), &sent, sizeof sent, descriptors) &&
      receive_message(socket_.get(), &received, sizeof received, none)) {
    return reply;
  }
  end();
  return std::nullopt;
}

Result<pid_t> Zygote::launch(const std::string& title, const HandedOver& files) {
  Request request;
  if (title.size() >= request.title.size()) {
    return fail(ErrorCode::InvalidArgument, "the names of robot and process are too long for a zygote");
  }
  std::copy(title.begin(), title.end(), request.title.begin());
  const Descriptor null(files.output < 0 ? ::open("/dev/null", O_WRONLY | O_CLOEXEC) : -1);
  const std::array<int, kHandedDescriptors> descriptors = {files.output < 0 ? null.get() : files.output,
                                                           files.assignment, files.listener, files.lock,
                                                           files.output_changes};
  const Lock lock(mutex_);
  const auto reply = ask(request, descriptors);
  if (!reply) return fail(ErrorCode::Unavailable, "the zygote is gone; its log says why");
  if (reply->pid <= 0) return system_error("the zygote cannot fork", reply->error);
  return reply->pid;
}

ExitReason Zygote::reap(int pid) {
  Request request;
  request.kind = ZygoteRequestKind::Reap;
  request.pid = pid;
  const Lock lock(mutex_);
  const auto reply = ask(request, {});
  ExitReason reason;
  reason.known = reply.has_value() && reply->pid == pid;
  if (!reason.known) return reason;
  if (reply->code == CLD_EXITED) {
    reason.status = reply->status;
  } else {
    reason.signal = reply->status;
    reason.core_dumped = reply->code == CLD_DUMPED;
  }
  return reason;
}

}  // namespace segue::process_server::detail
