// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/mutex.hpp>
#include <segue/process_server/process_service.hpp>
#include <segue/process_server/spawn.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// A zygote is a process with a single thread that has the component libraries loaded and relocated, and from
/// which deployment processes are forked: each starts some milliseconds faster than a newly executed program.
namespace segue::process_server::detail {

/// The process server's side of its zygote. Functions may be called from any thread, one request at a time.
/// After the first Unavailable the zygote is gone for good; its children go on.
class Zygote {
 public:
  /// Starts `program --zygote LIBRARY...` with its output in `log`. Returns before it is ready.
  static Result<std::unique_ptr<Zygote>> start(const std::filesystem::path& program,
                                               const std::vector<std::string>& libraries,
                                               const std::filesystem::path& log);
  /// Kills the zygote; its children go on.
  ~Zygote();
  Zygote(const Zygote&) = delete;
  Zygote& operator=(const Zygote&) = delete;

  /// Forks a deployment process with the descriptors that spawn() would give it. Its pid stays valid until
  /// reap(). Waits for the zygote's answer for 5 s at most; Unavailable after that.
  Result<pid_t> launch(const std::string& title, const HandedOver& files);
  /// The exit status of a child that has ended; not `known` where the zygote is gone.
  ExitReason reap(int pid);

 private:
  struct Request;
  struct Reply;
  Zygote(Descriptor socket, int pid) : socket_(std::move(socket)), pid_(pid) {}
  std::optional<Reply> ask(const Request& request, std::span<const int> descriptors);
  void end();

  Mutex mutex_;        ///< held during a request, so that each answer belongs to its request
  Descriptor socket_;  ///< invalid: the zygote is gone
  int pid_;
};

/// The arguments of main(), which run_zygote() overwrites in its children, so that `ps` shows their titles.
struct CommandLine {
  int count = 0;
  char** words = nullptr;
};

/// The work of a zygote and its children.
struct ZygoteWork {
  /// Loads a component library by its name, in the zygote.
  std::function<Result<void>(const std::string& library)> preload;
  /// Prepares a child for any deployment process that it may become.
  std::function<void()> prepare;
  /// Runs a deployment process to its end; in a child that is prepared.
  std::function<int()> deploy;
};

/// The zygote's side: preloads the libraries that its command line names, then forks deployment processes
/// until its server is gone. One child is always forked and prepared ahead (the spare), so that a process is
/// ready sooner; the spare ends with the zygote. In a child it answers what `deploy` does. Must begin with
/// one thread.
int run_zygote(CommandLine command, const ZygoteWork& work);

}  // namespace segue::process_server::detail
