// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/tasks.capnp.h>
#include <segue/control/detail/batch_server.hpp>
#include <segue/deploy/task_access.hpp>
#include <segue/rpc/detail/caller.hpp>

#include <memory>

namespace segue::control::detail {

/// Offers a TaskAccess to one client; the servers of deployment processes and of robots on hosts are this and
/// more. Only for use in the event loop.
class TaskAccessServer : public virtual wire::TaskAccess::Server {
 public:
  kj::Promise<void> perform(PerformContext context) override;
  kj::Promise<void> follow(FollowContext context) override;
  kj::Promise<void> saveState(SaveStateContext context) override;
  kj::Promise<void> restoreState(RestoreStateContext context) override;
  kj::Promise<void> describe(DescribeContext context) override;
  kj::Promise<void> properties(PropertiesContext context) override;
  kj::Promise<void> watch(WatchContext context) override;
  kj::Promise<void> details(DetailsContext context) override;
  kj::Promise<void> setProperty(SetPropertyContext context) override;
  kj::Promise<void> call(CallContext context) override;
  kj::Promise<void> write(WriteContext context) override;
  kj::Promise<void> openReader(OpenReaderContext context) override;

 protected:
  /// Calls in progress keep `tasks`, so the last of them may destroy it, on any thread.
  TaskAccessServer(Caller caller, std::shared_ptr<deploy::TaskAccess> tasks);
  [[nodiscard]] const Follower& follower() const { return follower_; }

 private:
  Caller caller_;
  const std::shared_ptr<deploy::TaskAccess> tasks_;
  const Follower follower_ = std::make_shared<kj::Maybe<wire::BatchFollower::Client>>();
};

}  // namespace segue::control::detail
