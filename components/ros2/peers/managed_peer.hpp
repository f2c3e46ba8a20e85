// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "peer.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace ros2::testing {

/// A managed node of ROS 2, which answers in a thread of its own, with faults.
class ManagedPeer {
 public:
  enum class Fault {
    None,
    Refuses,          ///< every transition, and stays where it is
    SaysDoneOnly,     ///< that it did it, and stays where it is
    AnswersNothing,   ///< to activate, but does it
    AnswersNever,     ///< to change_state, and stays where it is
    AnswersLate,      ///< half a second after it did it
    HasNoState,       ///< its responses to get_state are no messages
    FailsToActivate,  ///< and is unconfigured then, as one whose hook has an error
    Malformed,        ///< its responses to change_state are no messages
    DiesInConfigure   ///< its services leave, and nothing answers
  };

  /// `enters` is called in each transition, with its number, before the state changes.
  explicit ManagedPeer(
      const std::function<std::unique_ptr<Peer>()>& make_peer, std::string node = "/talker",
      std::function<void(int)> enters = [](int) {});
  ~ManagedPeer();
  ManagedPeer(const ManagedPeer&) = delete;
  ManagedPeer& operator=(const ManagedPeer&) = delete;

  void set_fault(Fault fault) { fault_ = fault; }
  /// The number of its state (lifecycle_msgs/msg/State).
  int state() const { return state_; }
  void set_state(int state) { state_ = state; }
  /// Its services leave, and come back.
  void hide(bool hidden) { hidden_ = hidden; }
  /// Whether its services are there, as told by hide().
  bool is_served() const { return served_; }
  /// The texts of parameters that it got: "rate: 10".
  std::vector<std::string> parameters() const;
  /// The transitions that it was asked for, by their numbers.
  std::vector<int> transitions() const;

 private:
  void serve();
  void answer();
  void answer_changes();
  void change(int transition);

  const std::string node_;
  const std::function<void(int)> enters_;
  segue::ros2::InterfaceLibrary library_;
  segue::ros2::MessageCodec codec(const std::string& message);
  const segue::ros2::MessageCodec change_request_ = codec("lifecycle_msgs/srv/ChangeState_Request");
  const segue::ros2::MessageCodec change_response_ = codec("lifecycle_msgs/srv/ChangeState_Response");
  const segue::ros2::MessageCodec state_response_ = codec("lifecycle_msgs/srv/GetState_Response");
  const segue::ros2::MessageCodec set_request_ = codec("rcl_interfaces/srv/SetParametersAtomically_Request");
  const segue::ros2::MessageCodec set_response_ =
      codec("rcl_interfaces/srv/SetParametersAtomically_Response");
  std::unique_ptr<Peer> change_state_;
  std::unique_ptr<Peer> get_state_;
  std::unique_ptr<Peer> set_parameters_;
  std::atomic<int> state_{1};
  std::atomic<Fault> fault_{Fault::None};
  std::atomic<bool> hidden_{false};
  std::atomic<bool> served_{true};
  std::atomic<bool> ends_{false};
  mutable segue::Mutex mutex_;
  std::vector<std::string> parameters_ SEGUE_GUARDED_BY(mutex_);
  std::vector<int> transitions_ SEGUE_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace ros2::testing
