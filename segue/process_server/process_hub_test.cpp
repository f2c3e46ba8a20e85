// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/process_server/process_hub.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace segue::process_server {
namespace {

/// Remembers what was asked, and tells of ends.
class AskedService final : public ProcessService {
 public:
  std::vector<std::string> asked;

  Result<ProcessInfo> start(const Launch& launch, TimePoint /*deadline*/) override {
    return info_of(launch.robot);
  }
  Result<ExitReason> stop(const std::string& robot, const model::DeploymentKey& /*key*/,
                          TimePoint /*deadline*/) override {
    asked.push_back("stop " + robot);
    return ExitReason{};
  }
  Result<ExitReason> kill(const std::string& robot, const model::DeploymentKey& /*key*/,
                          TimePoint /*deadline*/) override {
    asked.push_back("kill " + robot);
    return ExitReason{};
  }
  Result<std::vector<ProcessInfo>> processes(const std::string& robot) override {
    return std::vector{info_of(robot)};
  }
  void set_listener(Listener listener) override {
    const Lock lock(mutex_);
    listener_ = std::move(listener);
  }
  void end(const std::string& robot) {
    const Lock lock(mutex_);
    if (listener_) {
      listener_(info_of(robot));
    }
  }

 private:
  static ProcessInfo info_of(const std::string& robot) {
    ProcessInfo info;
    info.robot = robot;
    return info;
  }
  Mutex mutex_;
  Listener listener_;
};

TEST(ProcessHub, EachShareHearsOfItsRobotOnly) {
  AskedService service;
  ProcessHub hub(service);
  const auto spot = hub.for_robot("spot");
  const auto mule = hub.for_robot("mule");
  const auto all = hub.for_all();
  std::vector<std::string> heard;
  const auto listen = [&](ProcessService& share, const std::string& name) {
    share.set_listener([&heard, name](const ProcessInfo& info) { heard.push_back(name + info.robot); });
  };
  service.end("spot");
  listen(*spot, "spot hears ");
  listen(*mule, "mule hears ");
  service.end("spot");
  service.end("other");
  EXPECT_EQ(heard, std::vector<std::string>{"spot hears spot"});
  listen(*all, "all hear ");
  heard.clear();
  service.end("mule");
  service.end("other");
  std::sort(heard.begin(), heard.end());
  EXPECT_EQ(heard, (std::vector<std::string>{"all hear mule", "all hear other", "mule hears mule"}));
  spot->set_listener({});
  listen(*mule, "again ");
  heard.clear();
  service.end("spot");
  service.end("mule");
  std::sort(heard.begin(), heard.end());
  EXPECT_EQ(heard, (std::vector<std::string>{"again mule", "all hear mule", "all hear spot"}));
}

TEST(ProcessHub, QuestionsGoToTheService) {
  AskedService service;
  ProcessHub hub(service);
  const auto share = hub.for_robot("spot");
  Launch launch;
  launch.robot = "spot";
  EXPECT_EQ(share->start(launch, {})->robot, "spot");
  EXPECT_TRUE(share->stop("spot", {}, {}));
  EXPECT_TRUE(share->kill("spot", {}, {}));
  EXPECT_EQ(share->processes("spot")->front().robot, "spot");
  EXPECT_EQ(service.asked, (std::vector<std::string>{"stop spot", "kill spot"}));
}

TEST(ProcessHub, SharesOutliveIt) {
  AskedService service;
  auto hub = std::make_unique<ProcessHub>(service);
  const auto share = hub->for_all();
  int heard = 0;
  share->set_listener([&](const ProcessInfo&) { ++heard; });
  hub.reset();
  service.end("spot");
  EXPECT_EQ(heard, 0);
  share->set_listener({});
  EXPECT_TRUE(share->processes("spot"));
}

TEST(ProcessHub, SharesComeAndGoWhileProcessesEnd) {
  AskedService service;
  ProcessHub hub(service);
  std::atomic<bool> over{false};
  std::thread ends([&] {
    while (!over) {
      service.end("spot");
    }
  });
  std::vector<std::thread> users;
  for (int i = 0; i < 3; ++i) {
    users.emplace_back([&] {
      for (int round = 0; round < 200; ++round) {
        int heard = 0;  // not protected: nobody is told any more once the share is gone
        auto share = hub.for_robot(round % 2 == 0 ? "spot" : "mule");
        share->set_listener([&heard](const ProcessInfo&) { ++heard; });
        share->set_listener([&heard](const ProcessInfo&) { ++heard; });
        share.reset();
        EXPECT_TRUE(round % 2 == 0 || heard == 0);
      }
    });
  }
  for (auto& user : users) {
    user.join();
  }
  over = true;
  ends.join();
}

}  // namespace
}  // namespace segue::process_server
