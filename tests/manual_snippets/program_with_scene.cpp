// SPDX-License-Identifier: Apache-2.0
// Where the request of a run is made and an action is carried out, in a program with a geometric model.
#include <segue/mission_run/loaded_mission.hpp>

#include <string>

struct Scene {
  void move_to_gripper(const std::string& body);
  void put_down(const std::string& body);
  [[nodiscard]] segue::type::Value to_value() const;
};

void use(segue::mission_run::RunRequest& request, segue::mission::ActionCall& call) {
  // the snippet
}
