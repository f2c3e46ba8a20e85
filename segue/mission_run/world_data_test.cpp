// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <thread>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The boxes on the shelf, as a program's own model of the world has them.
class Shelf final : public mission::WorldData {
 public:
  [[nodiscard]] std::shared_ptr<mission::WorldData> clone() const override {
    return std::make_shared<Shelf>(*this);
  }
  void changed(const std::string& fact, bool holds) override {
    if (fact.starts_with("on_shelf(")) boxes += holds ? 1 : -1;
  }
  int boxes = 0;
};

/// Where boxes are, in metres.
using Scene = std::map<std::string, double>;

mission::WorldEffects<Scene> scene_effects() {
  mission::WorldEffects<Scene> effects;
  effects.on("+holding", [](Scene& scene, auto boxes) { scene["gripper"] = scene.at(boxes[0]); })
      .on("+holding", [](Scene& scene, auto boxes) { scene.erase(boxes[0]); })
      .on("-holding",
          [](Scene& scene, auto boxes) {
            scene[boxes[0]] = scene.at("gripper") + 1;
            scene.erase("gripper");
          })
      .shown_as([](const Scene& scene) {
        type::ValueMap places;
        for (const auto& [what, where] : scene)
          places.append(what, where);
        return type::Value(std::move(places));
      });
  return effects;
}

TEST_F(LoadedMissions, EffectsChangeDataOfAnyTypeThatScriptsSeeToo) {
  const LoadedMission plan = load("scene.yaml", R"j(mission: m
actions:
  grasp: {effects: ["+holding(red)"], run: {callback: grasp}}
  put: {effects: ["-holding(red)"], run: {callback: put}}
  plan: {outputs: {red: float}, pure: true, reads_world: true, run: {callback: plan}}
  tell:
    outputs: {seen: any}
    pure: true
    reads_world: true
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              outputs["seen"] = [self.world.holds("holding( red )"), sorted(self.world), self.world.data["scene"]]
              return 0
start: grasp
outputs: {seen: any, red: float}
flows: [tell.seen -> outputs.seen, plan.red -> outputs.red]
states:
  grasp: {on: {success: tell}}
  tell: {on: {success: put}}
  put: {on: {success: plan, aborted: plan}}
  plan: {on: {success: return success}}
)j");
  for (const bool slips : {false, true}) {
    for (const RunMode& mode : kBothModes) {
      SCOPED_TRACE(slips);
      RunRequest wanted = request(mode);
      wanted.clock = RunClock::Real;
      wanted.world_data.emplace("scene", mission::world_data(Scene{{"red", 2.0}}, scene_effects()));
      wanted.runners.add("grasp", [](mission::ActionCall&) { return mission::Ending{}; });
      wanted.runners.add("put", [&](mission::ActionCall&) {
        return slips ? mission::Ending{mission::kAborted, "it stuck"} : mission::Ending{};
      });
      wanted.runners.add("plan", [](mission::ActionCall& call) {
        const auto scene = mission::data_of<Scene>(call.world().value(), "scene");
        EXPECT_EQ(mission::data_of<int>(call.world().value(), "scene"), nullptr);
        call.set_output("red", type::Value(scene->contains("red") ? scene->at("red") : -1.0));
        return mission::Ending{};
      });
      const auto run = plan.run(wanted).value();
      const auto& outputs = run->overview().outputs;
      EXPECT_EQ(*outputs.find("red"), type::Value(slips ? -1.0 : 3.0))
          << "what was predicted wrongly is undone";
      EXPECT_EQ(type::to_json(*outputs.find("seen"), -1), R"j([true,["holding(red)"],{"gripper":2.0}])j");
    }
  }
}

/// The changes of facts, in their order.
mission::WorldEffects<std::string> noted_changes(const std::vector<std::string>& facts) {
  mission::WorldEffects<std::string> effects;
  for (const std::string& fact : facts) {
    for (const std::string sign : {"+", "-"})
      effects.on(sign + fact, [=](std::string& notes, auto) { notes += " " + sign + fact; });
  }
  return effects.shown_as([](const std::string& notes) { return type::Value(notes); });
}

std::string noted(const LoadedMission& plan, RunRequest request, const std::vector<std::string>& facts) {
  std::string seen;
  request.world_data.emplace("notes", mission::world_data(std::string(), noted_changes(facts)));
  request.runners.add("look", [&](mission::ActionCall& call) {
    seen = *mission::data_of<std::string>(call.world().value(), "notes");
    return mission::Ending{};
  });
  const auto run = plan.run(request).value();
  EXPECT_TRUE(run->overview().succeeded);
  return seen;
}

TEST_F(LoadedMissions, EffectsComeInTheOrderOfThePlan) {
  for (const std::string how : {"", "pure: true, "}) {
    const LoadedMission plan = load("order.yaml", R"j(mission: m
actions:
  slow: {effects: ["+a()"], run: {simulated: {duration: 4s}}}
  quick: {preconditions: ["!d()", "!b()"], effects: ["+c()", "+b()", "+d()"], run: {simulated: {duration: 1s}}}
  back: {effects: ["-c()"], run: {simulated: {duration: 1s}}}
  again: {effects: ["+c()"], run: {simulated: {duration: 1s}}}
  look: {)j" + how + R"j(reads_world: true, run: {callback: look}}
start: slow
states:
  slow: {on: {success: quick}}
  quick: {on: {success: as_written}}
  as_written:
    start: back
    on: {success: look}
    states:
      back: {on: {success: again, preempted: again}}
      again: {on: {success: return success}}
  look: {on: {success: return success}}
)j");
    for (const RunMode& mode : kBothModes) {
      EXPECT_EQ(noted(plan, request(mode), {"a", "b", "c", "d"}), " +a +c +b +d -c +c") << how;
    }
  }
}

TEST_F(LoadedMissions, FactsThatCameToTheSameInAnotherWayAreNotTheSameToData) {
  const LoadedMission plan = load("ways.yaml", R"j(mission: m
actions:
  open: {effects: ["+open()"], run: {simulated: {duration: 4s, outcomes: [aborted]}}, expect: {duration: 4s}}
  close: {effects: ["-open()"], run: {simulated: {duration: 1s}}}
  look: {pure: true, reads_world: true, run: {callback: look}}
start: open
states:
  open: {on: {success: close, aborted: close}}
  close: {on: {success: look}}
  look: {on: {success: return success}}
)j");
  for (const RunMode& mode : kBothModes) {
    EXPECT_EQ(noted(plan, request(mode), {"open"}), "");
  }
}

/// Boxes that are lifted and put down, by functions that do not commute.
constexpr const char* kScriptedScene = R"j(mission: m
world_data:
  scene:
    initial: {red: 2.0}
    python: scene.py
    effects: {"+holding": lift, "-holding": put}
actions:
  grasp: {effects: ["+holding(red)", "+seen(red)"], run: {callback: grasp}}
  put: {effects: ["-holding(red)"], run: {callback: put}}
  tell:
    outputs: {seen: any}
    pure: true
    reads_world: true
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              outputs["seen"] = [sorted(self.world.data), dict(self.world.data["scene"])]
              self.world.data["scene"].clear()
              return 0
start: grasp
outputs: {first: any, last: any}
flows: [first.seen -> outputs.first, last.seen -> outputs.last]
states:
  grasp: {on: {success: first}}
  first: {action: tell, on: {success: put}}
  put: {on: {success: last, aborted: last}}
  last: {action: tell, on: {success: return success}}
)j";

TEST_F(LoadedMissions, DataFollowFactsByFunctionsInPython) {
  write("scene.py",
        "def lift(scene, box):\n  scene['gripper'] = scene.pop(box)\n"
        "def put(scene, box):\n  return {**{k: v for k, v in scene.items() if k != 'gripper'},\n"
        "          box: scene['gripper'] + 1}\n");
  const LoadedMission plan = load("scripted.yaml", kScriptedScene);
  for (const bool slips : {false, true}) {
    for (const RunMode& mode : kBothModes) {
      SCOPED_TRACE(slips);
      RunRequest wanted = request(mode);
      wanted.clock = RunClock::Real;
      wanted.runners.add("put", [&](mission::ActionCall&) {
        return slips ? mission::Ending{mission::kAborted, "it stuck"} : mission::Ending{};
      });
      const auto run = plan.run(wanted).value();
      const auto& outputs = run->overview().outputs;
      ASSERT_TRUE(run->overview().succeeded);
      EXPECT_EQ(type::to_json(*outputs.find("first"), -1), R"j([["scene"],{"gripper":2.0}])j");
      EXPECT_EQ(type::to_json(*outputs.find("last"), -1),
                slips ? R"j([["scene"],{"gripper":2.0}])j" : R"j([["scene"],{"red":3.0}])j");
      wanted.world_data.emplace("scene", mission::world_data(Scene(), scene_effects()));
      EXPECT_EQ(plan.run(wanted).error().code, ErrorCode::InvalidArgument) << "both have a scene";
    }
  }
}

TEST_F(LoadedMissions, ActionsSeeTheWorldThatIsPredictedWithWhatIsAttachedToIt) {
  const LoadedMission plan = load("world.yaml", R"j(mission: m
actions:
  place: {inputs: {box: text}, effects: ["+on_shelf({box})"], run: {callback: place}}
  plan: {outputs: {seen: int}, pure: true, reads_world: true, run: {callback: plan}}
  blind: {pure: true, run: {callback: blind}}
start: first
outputs: {seen: int}
flows: [plan.seen -> outputs.seen]
states:
  first: {action: place, inputs: {box: a}, on: {success: second, aborted: second}}
  second: {action: place, inputs: {box: b}, on: {success: plan}}
  plan: {on: {success: blind}}
  blind: {on: {success: return success}}
)j");
  for (const bool fails : {false, true}) {
    for (const RunMode& mode : kBothModes) {
      RunRequest wanted = request(mode);
      std::vector<std::int64_t> planned;
      wanted.world_data.emplace("shelf", std::make_shared<Shelf>());
      wanted.runners.add("place", [&](mission::ActionCall& call) {
        const bool ends_well = !fails || call.input("box") == type::Value("b");
        return ends_well ? mission::Ending{} : mission::Ending{mission::kAborted, "it slipped"};
      });
      wanted.runners.add("plan", [&](mission::ActionCall& call) {
        const auto world = call.world().value();
        const auto shelf = world.attached<Shelf>("shelf");
        planned.push_back(shelf->boxes);
        EXPECT_EQ(shelf->boxes, static_cast<int>(world.facts().size()));
        EXPECT_TRUE(world.holds("on_shelf(b)") && world.holds("on_shelf( b )"));
        EXPECT_EQ(world.attached<Shelf>("table"), nullptr);
        call.set_output("seen", type::Value(static_cast<std::int64_t>(shelf->boxes)));
        return mission::Ending{};
      });
      wanted.runners.add("blind", [](mission::ActionCall& call) {
        EXPECT_EQ(call.world().error().code, ErrorCode::InvalidState) << "it does not declare reads_world";
        return mission::Ending{};
      });
      const auto run = plan.run(wanted).value();
      EXPECT_EQ(*run->overview().outputs.find("seen"), type::Value(fails ? 1 : 2));
      const bool ahead = is_concurrent(mode);
      if (fails && ahead) {
        EXPECT_THAT(planned, ElementsAre(2, 1)) << "the prediction was wrong";
      } else {
        EXPECT_THAT(planned, ElementsAre(fails ? 1 : 2));
      }
    }
  }
}

}  // namespace
}  // namespace segue::mission_run
