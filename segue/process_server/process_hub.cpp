// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/process_server/process_hub.hpp>

#include <set>
#include <utility>

namespace segue::process_server {

struct ProcessHub::Listeners {
  Mutex mutex;  ///< protects the set; held while shares are told
  std::set<Share*> shares;
  void tell(const ProcessInfo& ended);
};

class ProcessHub::Share final : public ProcessService {
 public:
  Share(ProcessService& processes, std::shared_ptr<Listeners> listeners, std::string robot)
      : processes_(processes), listeners_(std::move(listeners)), robot_(std::move(robot)) {}
  ~Share() override { set_listener({}); }

  Result<ProcessInfo> start(const Launch& launch, TimePoint deadline) override {
    return processes_.start(launch, deadline);
  }
  Result<ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                          TimePoint deadline) override {
    return processes_.stop(robot, key, deadline);
  }
  Result<ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                          TimePoint deadline) override {
    return processes_.kill(robot, key, deadline);
  }
  Result<std::vector<ProcessInfo>> processes(const std::string& robot) override {
    return processes_.processes(robot);
  }

  void set_listener(Listener listener) override {
    const Lock lock(listeners_->mutex);
    listener_ = std::move(listener);
    listener_ ? void(listeners_->shares.insert(this)) : void(listeners_->shares.erase(this));
  }

  void tell(const ProcessInfo& ended) const {
    if (robot_.empty() || robot_ == ended.robot) {
      listener_(ended);
    }
  }

 private:
  ProcessService& processes_;
  const std::shared_ptr<Listeners> listeners_;
  const std::string robot_;  ///< empty: all
  Listener listener_;
};

void ProcessHub::Listeners::tell(const ProcessInfo& ended) {
  const Lock lock(mutex);
  for (const Share* share : shares) {
    share->tell(ended);
  }
}

ProcessHub::ProcessHub(ProcessService& processes)
    : processes_(processes), listeners_(std::make_shared<Listeners>()) {
  processes_.set_listener([listeners = listeners_](const ProcessInfo& ended) { listeners->tell(ended); });
}

ProcessHub::~ProcessHub() {
  processes_.set_listener({});
}

std::unique_ptr<ProcessService> ProcessHub::for_robot(std::string robot) {
  return std::make_unique<Share>(processes_, listeners_, std::move(robot));
}

std::unique_ptr<ProcessService> ProcessHub::for_all() {
  return std::make_unique<Share>(processes_, listeners_, std::string());
}

}  // namespace segue::process_server
