// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/peer.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace segue::control {

/// A request about a robot and its files, through either server: its runtime's or the studio.
enum class Verb : std::uint8_t {
  Status,
  Task,
  Watch,
  Running,
  Changes,
  Events,
  History,
  Past,
  Mission,
  Conflicts,
  Units,
  OpenPort,
  Plan,
  Switch,
  Apply,
  Repair,
  Prepare,
  Cancel,
  ApplyTransition,
  ResetBelief,
  Lease,
  GiveBack,
  Report,
  SendCommand,
  Stop,
  ReleaseStop,
  Set,
  Call,
  TakeInstance,
  Write,
  SetUnits,
  ShutDown,
  LookAtFiles,
  LookAtRos2,
  ChangeFiles,
  RunScripts  ///< to start missions whose Python runs as the user of a server
};

struct VerbRule {
  Verb verb = Verb::Status;
  std::string_view name{};
  Role role = Role::Administer;  ///< the least that may ask it
};

/// The only table of who may do what, in the order of the verbs.
inline constexpr std::array<VerbRule, 36> kVerbRules = {
    {{Verb::Status, "status", Role::Observe},
     {Verb::Task, "task", Role::Observe},
     {Verb::Watch, "watch", Role::Observe},
     {Verb::Running, "running", Role::Observe},
     {Verb::Changes, "changes", Role::Observe},
     {Verb::Events, "events", Role::Observe},
     {Verb::History, "history", Role::Observe},
     {Verb::Past, "past", Role::Observe},
     {Verb::Mission, "mission", Role::Observe},
     {Verb::Conflicts, "conflicts", Role::Observe},
     {Verb::Units, "units", Role::Observe},
     {Verb::OpenPort, "open_port", Role::Observe},
     {Verb::Plan, "plan", Role::Observe},
     {Verb::Switch, "switch", Role::Operate},
     {Verb::Apply, "apply", Role::Operate},
     {Verb::Repair, "repair", Role::Operate},
     {Verb::Prepare, "prepare", Role::Operate},
     {Verb::Cancel, "cancel", Role::Operate},
     {Verb::ApplyTransition, "apply_transition", Role::Operate},
     {Verb::ResetBelief, "reset_belief", Role::Operate},
     {Verb::Lease, "lease", Role::Operate},
     {Verb::GiveBack, "give_back", Role::Operate},
     {Verb::Report, "report", Role::Operate},
     {Verb::SendCommand, "send_command", Role::Operate},
     {Verb::Stop, "stop", Role::Operate},
     {Verb::ReleaseStop, "release_stop", Role::Operate},
     {Verb::Set, "set", Role::Operate},
     {Verb::Call, "call", Role::Operate},
     {Verb::TakeInstance, "take_instance", Role::Operate},
     {Verb::Write, "write", Role::Operate},
     {Verb::SetUnits, "set_units", Role::Operate},
     {Verb::ShutDown, "shut_down", Role::Operate},
     {Verb::LookAtFiles, "look_at_files", Role::Observe},
     {Verb::LookAtRos2, "look_at_ros2", Role::Observe},
     {Verb::ChangeFiles, "change_files", Role::Operate},
     {Verb::RunScripts, "run_scripts", Role::Administer}}};

constexpr const VerbRule& rule_of(Verb verb) {
  return kVerbRules.at(static_cast<std::size_t>(verb));
}

/// The role that a verb needs. To take the robot from whoever commands it needs a higher one than to command
/// it.
constexpr Role role_for(Verb verb, bool take_over = false) {
  return take_over ? Role::Administer : rule_of(verb).role;
}

constexpr bool verb_rules_are_in_order() {
  for (std::size_t i = 0; i < kVerbRules.size(); ++i)
    if (kVerbRules.at(i).verb != static_cast<Verb>(i)) return false;
  return kVerbRules.back().verb == Verb::RunScripts;
}
static_assert(verb_rules_are_in_order());

}  // namespace segue::control
