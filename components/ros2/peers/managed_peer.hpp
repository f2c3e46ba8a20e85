// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "peer.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
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

  /// `enters` is called in each transition, with its number, before the state changes. Not `tells`: it does
  /// not answer what values its parameters have.
  explicit ManagedPeer(
      const std::function<std::unique_ptr<Peer>()>& make_peer, std::string node = "/talker",
      std::function<void(int)> enters = [](int) {}, bool tells = true);
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
  /// The whole numbers that it has: rate is 5 and pid.order 1 at first; 0: there is none.
  std::int64_t value(const std::string& parameter) const;
  /// By somebody else.
  void set_value(const std::string& parameter, std::int64_t value);
  /// The transitions that it was asked for, by their numbers.
  std::vector<int> transitions() const;

 private:
  void serve();
  void answer();
  [[nodiscard]] std::vector<Peer*> peers() const;
  void answer_parameters();
  [[nodiscard]] segue::type::Value told(const segue::type::Value& names) const;
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
  const segue::ros2::MessageCodec get_request_ = codec("rcl_interfaces/srv/GetParameters_Request");
  const segue::ros2::MessageCodec get_response_ = codec("rcl_interfaces/srv/GetParameters_Response");
  const segue::ros2::MessageCodec set_response_ =
      codec("rcl_interfaces/srv/SetParametersAtomically_Response");
  std::unique_ptr<Peer> change_state_;
  std::unique_ptr<Peer> get_state_;
  std::unique_ptr<Peer> set_parameters_;
  std::unique_ptr<Peer> get_parameters_;  ///< nullptr: another one answers that
  std::atomic<int> state_{1};
  std::atomic<Fault> fault_{Fault::None};
  std::atomic<bool> hidden_{false};
  std::atomic<bool> served_{true};
  std::atomic<bool> ends_{false};
  mutable segue::Mutex mutex_;
  std::vector<std::string> parameters_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, std::int64_t> values_ SEGUE_GUARDED_BY(mutex_){{"rate", 5}, {"pid.order", 1}};
  std::vector<int> transitions_ SEGUE_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace ros2::testing
