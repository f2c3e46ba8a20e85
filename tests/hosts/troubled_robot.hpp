// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/distributed/distributed_task_host.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <support/fake_hosts.hpp>

#include <array>
#include <atomic>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// A robot on several simulated hosts, with a real runtime and real daemons. Between them, and in the
/// processes, there is trouble as a test wishes.
namespace segue::distributed::testing {

enum class TroubleKind {
  MessageLost,      ///< the connection breaks before a call was carried out; the host stays lost
  AnswerLost,       ///< the connection breaks after a call was carried out; the host stays lost
  MessageLostOnce,  ///< as above, but the host can be connected again at once
  AnswerLostOnce,
  Unanswered,       ///< a call is carried out, but its answer comes too late
  Refused,          ///< a call is refused without effect
  Slow,             ///< a call takes a while
  LateCommit,       ///< the order to commit arrives after the promise; the host stays lost until then
  LateCommitAgain,  ///< likewise, but the host is connected again meanwhile
  ClockJumps,       ///< the host's clock goes ahead, so that its promises run out
  DaemonRestarts,   ///< the host's daemon starts again; its processes live on
  HostRestarts,     ///< the host starts again with nothing
  Rival,            ///< another runtime takes the robot on this host, and does nothing with it
  RivalEndsAll,     ///< another runtime takes the robot on this host, and ends its processes there
  ActionFails,      ///< a call of a process fails without effect
  ActionDoubted,    ///< a call of a process takes effect, but is not answered
  ProcessHangs,
  ProcessDies,           ///< before a call
  ProcessDiesAfterwards  ///< after a call took effect
};
inline constexpr std::size_t kTroubleKinds = 19;
[[nodiscard]] constexpr bool is_of_process(TroubleKind kind) {
  return kind >= TroubleKind::ActionFails;
}
std::string_view to_string(TroubleKind kind);

/// Trouble at a call to a host or, for processes, at a call to one of its processes.
struct Trouble {
  TroubleKind kind{};
  int host = 0;
  int call = 0;  ///< which of kCalls; for processes the number of the call
  int nth = 1;   ///< at the nth such call of a request
};
inline constexpr std::array<std::string_view, 9> kCalls = {"begin actions", "commit",           "vote",
                                                           "arm_commit",    "begin_transition", "get_ready",
                                                           "conclude",      "withdraw",         "snapshot"};
std::string to_string(const Trouble& trouble);

/// Defects that tests plant into the simulated parts, to see that they are found.
enum class Planted {
  Nothing,
  LostCommitCountsAsDone,  ///< an order to commit does not arrive, and the runtime hears that it was obeyed
  LostActionsCountAsDone,  ///< actions are not carried out, and the runtime hears that they were
  OldViewCountsAsPresent,  ///< what a host says that it holds is what it held before
  LeaseIsNotChecked,       ///< a runtime whose robot was taken over is obeyed
  PromiseLasts,            ///< a host commits although it is told to too late
  RefusalCountsAsPromise,  ///< a host refuses to promise, and the runtime hears that it promises
  EndedProcessLivesOn      ///< a process that was ended lives on
};
std::string_view to_string(Planted planted);

/// What there is, sorted: "PROCESS: TASK STATE" and connections, with the plain ids of all incarnations.
std::vector<std::string> inventory(const model::Network& network);
std::vector<std::string> changes_between(const std::vector<std::string>& was,
                                         const std::vector<std::string>& is);
std::vector<std::string> changes_between(const model::Network& before, const model::Network& after);

class TroubledRobot {
 public:
  /// Names hosts "h0", "h1" and so on; `optional` has a bit for each.
  TroubledRobot(int hosts, unsigned optional, Planted planted);
  ~TroubledRobot();
  TroubledRobot(const TroubledRobot&) = delete;
  TroubledRobot& operator=(const TroubledRobot&) = delete;

  [[nodiscard]] runtime::Runtime& runtime() { return command_->runtime; }
  [[nodiscard]] DistributedTaskHost& host() { return command_->host; }
  [[nodiscard]] std::size_t hosts() const { return computers_.size(); }
  [[nodiscard]] model::HostName name(std::size_t host) const;
  [[nodiscard]] bool optional(std::size_t host) const { return (optional_ >> host & 1U) != 0; }
  /// The runtime ends, and another one begins, which takes the robot from whoever has it.
  void restart_runtime();
  /// Another runtime has got the robot on some host, and this one knows: then it has lost all hosts, until
  /// another one begins.
  [[nodiscard]] bool has_lost_robot();
  /// The runtime will know before long, since such a host can be asked.
  [[nodiscard]] bool must_be_lost() const;

  /// Nobody reaches the host, until heal().
  void cut(std::size_t host);
  /// And is commanded by the runtime.
  [[nodiscard]] bool can_be_reached(std::size_t host) const;
  /// Waits until the runtime knows which hosts can be reached, and has nothing to do. Empty; or what keeps
  /// it.
  std::string settle();

  /// From the beginning of the next transition on.
  void arm(const std::vector<Trouble>& troubles);
  /// There is no more trouble from now on, but hosts that are lost stay so. What arrives late does so now.
  void disarm();
  [[nodiscard]] std::vector<Trouble> struck() const;
  /// All hosts can be reached again, and the runtime commands them. Processes that hang go on hanging.
  void heal();

  /// What really runs on a host; on the runtime's own computer without one.
  [[nodiscard]] model::Network truth(std::optional<std::size_t> host) const;
  /// Endpoints of connections without another end, and where they are.
  [[nodiscard]] std::vector<std::string> orphans() const;
  /// The part of a network that belongs there.
  [[nodiscard]] model::Network part(const model::Network& network, std::optional<std::size_t> host) const;
  /// What no host may ever do, as sentences: such as to obey a runtime that does not command it.
  [[nodiscard]] std::vector<std::string> violations();

 private:
  struct Command {
    explicit Command(TroubledRobot& robot);
    task_host::LibrarySet libraries;
    model::ComponentCatalog catalog;
    task_host::LocalTaskHost local{
        libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
    deploy::testing::FakeProcesses processes;
    deploy::testing::FakeService service;
    fleet::DeployedTaskHost own;
    DistributedTaskHost host;
    runtime::Runtime runtime;
  };
  struct Trap {
    Trouble trouble;
    int met = 0;
    bool struck = false;
  };
  /// Another runtime that has the robot on one host.
  struct Rival {
    std::shared_ptr<HostedRobot> session;
    model::Network frozen;  ///< what the host held when it got the robot
  };
  enum class Moment { Before, After };
  enum class Promise { None, Asked, Given };

  [[nodiscard]] bool is_commanded(std::size_t host) const;
  /// What of hosts that are lost, found or commanded the runtime does not know yet, as a sentence; or empty.
  [[nodiscard]] std::string unnoticed();
  void watch(std::size_t host);
  void plant(std::size_t host);
  [[nodiscard]] std::vector<HostPlace> places() const;
  std::optional<Error> meet(std::size_t host, const std::string& what, Moment moment);
  std::optional<TroubleKind> next_trouble(std::size_t host, const std::string& what, Moment moment);
  std::optional<Error> strike(std::size_t host, TroubleKind kind);
  bool delays_commit(std::size_t host);
  void restart(std::size_t host, bool with_processes);
  void enter_rival(std::size_t host, bool ends_all);
  void later(std::function<void()> what);
  /// Forgets those whose leases have run out.
  void renew_rivals();
  void witness(std::size_t host, const std::string& what, bool succeeded);
  void check_promises(std::size_t host);

  const unsigned optional_;
  const Planted planted_;
  deploy::testing::FakeWorld own_;
  std::vector<std::unique_ptr<Computer>> computers_;
  Mutex entering_;       ///< one rival enters at a time; taken before `mutex_`
  mutable Mutex mutex_;  ///< protects everything below but `command_`
  std::vector<Trap> traps_;
  bool armed_ = false;
  bool in_transition_ = false;
  std::map<std::size_t, Promise> promises_;  ///< of the hosts that are armed
  std::map<std::size_t, Rival> rivals_;
  std::set<std::size_t> usurped_;  ///< where another runtime has got the robot since this one began
  std::map<std::size_t, HostView> first_views_;
  std::vector<std::string> violations_;
  std::vector<std::future<void>> later_;
  int runtimes_ = 0;
  std::unique_ptr<Command> command_;
};

}  // namespace segue::distributed::testing
