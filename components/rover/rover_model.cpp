// SPDX-License-Identifier: Apache-2.0
#include "rover_model.hpp"

#include <segue/base/mutex.hpp>

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <vector>

namespace rover {
namespace {

/// Numbers as MJCF wants them, independent of the locale.
std::string numbers(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    if (!text.empty()) text += ' ';
    text.append(buffer.data(), end);
  }
  return text;
}
std::string numbers(std::initializer_list<double> values) {
  return numbers(std::span(values.begin(), values.size()));
}

/// name="value", with a blank before it.
std::string with(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}
std::string with(const char* name, std::initializer_list<double> values) {
  return with(name, numbers(values));
}
std::string element(const char* name, const std::string& attributes) {
  return std::string("<") + name + attributes + "/>\n";
}

/// A wheel below a joint that steers it. It is drawn as a cylinder and touches the ground as an ellipsoid, so
/// that there is one point of contact, below the steering axis.
std::string wheel(const WheelPlace& place) {
  const std::string name = place.name;
  return "<body" + with("name", "strut_" + name) + with("pos", {place.x, place.y, kWheelRadius}) + ">\n" +
         element("joint", with("name", "steer_" + name) + with("axis", {0, 0, 1}) +
                              with("range", {-kLargestSteering, kLargestSteering}) + with("class", "steer")) +
         element("geom", with("class", "shape") + with("type", "cylinder") + with("size", {0.02, 0.06}) +
                             with("pos", {0, 0, 0.12}) + with("mass", {0.5})) +
         "<body" + with("name", "wheel_" + name) + ">\n" +
         element("joint", with("name", "drive_" + name) + with("axis", {0, 1, 0}) + with("class", "drive")) +
         element("geom", with("class", "tyre") + with("type", "ellipsoid") + with("mass", {1.0}) +
                             with("size", {kWheelRadius, 0.05, kWheelRadius})) +
         element("geom", with("class", "shape") + with("type", "cylinder") +
                             with("size", {kWheelRadius, 0.04}) + with("zaxis", {0, 1, 0}) +
                             with("rgba", {0.15, 0.15, 0.15, 1})) +
         element("geom", with("class", "shape") + with("type", "box") + with("size", {0.08, 0.042, 0.01}) +
                             with("rgba", {0.7, 0.7, 0.7, 1})) +
         "</body>\n</body>\n";
}

std::string finger(const char* name, double side) {
  return std::string("<body") + with("name", std::string(name) + "_finger") + with("pos", {kTool[0], 0, 0}) +
         ">\n" +
         element("joint", with("name", std::string(name) + "_finger") + with("type", "slide") +
                              with("axis", {0, side, 0}) + with("range", {0, kLargestOpening / 2}) +
                              with("damping", {40}) + with("armature", {0.1})) +
         element("geom", with("class", "pad") + with("type", "box") + with("size", {0.025, 0.006, 0.012}) +
                             with("pos", {-0.005, side * 0.006, 0}) + with("mass", {0.05})) +
         "</body>\n";
}

std::string hand() {
  return element("geom", with("class", "arm") + with("type", "box") + with("size", {0.015, 0.055, 0.02}) +
                             with("pos", {0.085, 0, 0}) + with("mass", {0.3})) +
         element("site", with("name", "tool") + with("pos", numbers(kTool))) +
         element("camera", with("name", "gripper") + with("pos", {0.05, 0, 0.08}) +
                               with("xyaxes", {0, -1, 0, 0.26, 0, 0.966}) +
                               with("fovy", {kFieldOfView * 180 / mjPI})) +
         finger("left", 1) + finger("right", -1);
}

/// The joints from `index` on, each inside the one before.
std::string arm(std::size_t index) {
  const ArmJoint& joint = kArm.at(index);
  const std::string name = "arm_" + std::to_string(index + 1);
  const bool last = index + 1 == kArm.size();
  const std::array<double, 3> next = last ? std::array<double, 3>{0.08, 0, 0} : kArm.at(index + 1).place;
  return "<body" + with("name", name) + with("pos", numbers(joint.place)) + ">\n" +
         element("joint", with("name", name) + with("axis", numbers(joint.axis)) +
                              with("range", {joint.lowest, joint.highest}) + with("class", "arm")) +
         element("geom", with("class", "arm") + with("type", "capsule") + with("mass", {last ? 0.3 : 0.8}) +
                             with("size", {index < 3 ? 0.035 : 0.025}) +
                             with("fromto", "0 0 0 " + numbers(next))) +
         (last ? hand() : arm(index + 1)) + "</body>\n";
}

std::string rover_body() {
  std::string text = "<body" + with("name", "rover") + ">\n<freejoint name=\"rover\"/>\n";
  text += element("geom", with("class", "hull") + with("type", "box") + with("size", {0.38, 0.20, 0.05}) +
                              with("pos", {0, 0, 0.22}) + with("mass", {25}));
  // The deck juts out over the wheels, which would climb what they touch first.
  text += element("geom", with("class", "hull") + with("type", "box") + with("size", {0.43, 0.36, 0.02}) +
                              with("pos", {0, 0, kDeckHeight - 0.02}) + with("mass", {5}));
  text += element("geom", with("class", "shape") + with("type", "cylinder") + with("size", {0.02}) +
                              with("fromto", {0.05, 0.17, 0.31, 0.05, 0.17, 0.93}) + with("mass", {0.5}));
  text += element("geom", with("class", "shape") + with("type", "box") + with("size", {0.03, 0.05, 0.03}) +
                              with("pos", {0.05, 0.17, 0.95}) + with("mass", {0.3}));
  text += element("geom", with("class", "shape") + with("type", "cylinder") + with("size", {0.03, 0.03}) +
                              with("pos", numbers(kLidarPlace)) + with("mass", {0.2}));
  text += element("site", with("name", "imu") + with("pos", {0, 0, 0.24}));
  text += element("site", with("name", "lidar") + with("pos", numbers(kLidarPlace)));
  text += element("camera", with("name", "mast") + with("pos", {0.09, 0.17, 0.95}) +
                                with("xyaxes", {0, -1, 0, 0.5, 0, 0.866}) +
                                with("fovy", {kFieldOfView * 180 / mjPI}));
  text += element("camera", with("name", "deck") + with("pos", {0.0, 0.11, 0.95}) +
                                with("xyaxes", {-1, 0, 0, 0, -0.8915, 0.4531}) +
                                with("fovy", {kFieldOfView * 180 / mjPI}));
  for (const WheelPlace& place : kWheelPlaces)
    text += wheel(place);
  return text + arm(0) + "</body>\n";
}

std::string solid(const char* type, std::initializer_list<double> size, std::initializer_list<double> place,
                  std::initializer_list<double> colour) {
  return element("geom", with("class", "room") + with("type", type) + with("size", size) +
                             with("pos", place) + with("rgba", colour));
}

std::string room() {
  constexpr double kAt = kWallDistance + 0.05;  // walls are 0.1 m thick
  const auto wall = {0.75, 0.75, 0.7, 1.0};
  const auto wood = {0.45, 0.32, 0.2, 1.0};
  const auto blue = {0.2, 0.3, 0.55, 1.0};
  return element("geom", with("class", "room") + with("type", "plane") + with("size", {5, 5, 1}) +
                             with("rgba", {0.5, 0.5, 0.45, 1})) +
         solid("box", {0.05, kAt, 0.4}, {kAt, 0, 0.4}, wall) +
         solid("box", {0.05, kAt, 0.4}, {-kAt, 0, 0.4}, wall) +
         solid("box", {kAt, 0.05, 0.4}, {0, kAt, 0.4}, wall) +
         solid("box", {kAt, 0.05, 0.4}, {0, -kAt, 0.4}, wall) +
         solid("box", {0.25, 0.5, kTableHeight / 2}, {kTableEdge + 0.25, 0, kTableHeight / 2}, wood) +
         solid("cylinder", {0.2, 0.4}, {1.0, 1.8, 0.4}, blue) +
         solid("cylinder", {0.2, 0.4}, {-1.8, 1.2, 0.4}, blue) +
         solid("box", {0.3, 0.15, 0.3}, {-1.0, -1.8, 0.3}, blue);
}

std::string box(std::size_t number) {
  const std::string name = "box_" + std::to_string(number);
  const double y = 0.2 * (static_cast<double>(number) - 1);
  return "<body" + with("name", name) + with("pos", {kTableEdge + 0.12, y, kTableHeight + kBoxSide / 2}) +
         ">\n<freejoint" + with("name", name) + "/>\n" +
         element("geom", with("class", "box") + with("type", "box") + with("material", name) +
                             with("size", {kBoxSide / 2, kBoxSide / 2, kBoxSide / 2})) +
         "</body>\n";
}

std::string actuators() {
  std::string text = "<actuator>\n";
  for (const WheelPlace& place : kWheelPlaces) {
    text += element("position", with("joint", std::string("steer_") + place.name) + with("kp", {200}) +
                                    with("forcerange", {-40, 40}));
  }
  for (const WheelPlace& place : kWheelPlaces) {
    text += element("velocity", with("joint", std::string("drive_") + place.name) + with("kv", {8}) +
                                    with("forcerange", {-20, 20}));
  }
  for (std::size_t index = 0; index < kArm.size(); ++index) {
    const double most = kArm.at(index).largest_torque;
    text += element("position", with("joint", "arm_" + std::to_string(index + 1)) + with("kp", {20 * most}) +
                                    with("forcerange", {-most, most}));
  }
  text += element("position", with("joint", "left_finger") + with("kp", {2000}) +
                                  with("forcerange", {-2 * kGripForce, 2 * kGripForce}));
  return text + "</actuator>\n";
}

/// Robot parts have a bit of their own for contacts, so that they touch everything but each other; lasers see
/// group 0 only.
constexpr const char* kDefaults = R"(<default>
<default class="room"><geom contype="1" conaffinity="1" group="0" friction="1 0.005 0.0001"/></default>
<default class="box"><geom contype="1" conaffinity="1" group="0" friction="1 0.01 0.0001" condim="4" mass="0.1" solref="0.005 1"/></default>
<default class="shape"><geom contype="0" conaffinity="0" group="1" mass="0" rgba="0.6 0.6 0.65 1"/></default>
<default class="hull"><geom contype="2" conaffinity="1" group="1" rgba="0.85 0.8 0.7 1"/></default>
<default class="tyre"><geom contype="2" conaffinity="1" group="3" friction="1 0.005 0.0001"/></default>
<default class="arm">
<geom contype="2" conaffinity="1" group="1" rgba="0.9 0.5 0.1 1"/>
<joint damping="20" armature="0.1"/>
</default>
<default class="pad"><geom contype="2" conaffinity="1" group="1" friction="1.5 0.02 0.0001" condim="4" solref="0.005 1" rgba="0.2 0.2 0.2 1"/></default>
<default class="steer"><joint damping="10" armature="0.1"/></default>
<default class="drive"><joint damping="0.01" armature="0.02"/></default>
</default>
)";

std::string assets() {
  std::string text =
      "<asset>\n<texture type=\"skybox\" builtin=\"flat\" rgb1=\"0.6 0.7 0.8\" width=\"8\" height=\"8\"/>\n";
  for (std::size_t number = 0; number < kBoxes; ++number) {
    const std::string name = "box_" + std::to_string(number);
    text += element("texture", with("name", name) + with("type", "cube") + with("file", name + ".texture"));
    text += element("material", with("name", name) + with("texture", name) + with("specular", {0}));
  }
  return text + "</asset>\n";
}

/// The marker as MuJoCo's own texture format: width, height, three bytes for each pixel. Each cell of the
/// marker is enlarged, since textures are smoothed.
std::vector<std::uint8_t> marker_texture(apriltag_family_t* family, std::size_t number) {
  constexpr int kEnlarged = 16;
  image_u8_t* const cells = apriltag_to_image(family, static_cast<int>(number));
  const std::array<std::int32_t, 2> size = {cells->width * kEnlarged, cells->height * kEnlarged};
  std::vector<std::uint8_t> texture(sizeof size);
  std::memcpy(texture.data(), size.data(), sizeof size);
  for (int y = 0; y < size[1]; ++y) {
    for (int x = 0; x < size[0]; ++x)
      texture.insert(texture.end(), 3, cells->buf[y / kEnlarged * cells->stride + x / kEnlarged]);
  }
  image_u8_destroy(cells);
  return texture;
}

class Files {
 public:
  Files() : files_(std::make_unique<mjVFS>()) { mj_defaultVFS(files_.get()); }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  ~Files() { mj_deleteVFS(files_.get()); }

  [[nodiscard]] const mjVFS* get() const { return files_.get(); }
  void add(const std::string& name, const void* content, std::size_t size) {
    mj_makeEmptyFileVFS(files_.get(), name.c_str(), static_cast<int>(size));
    std::memcpy(files_->filedata[mj_findFileVFS(files_.get(), name.c_str())], content, size);
  }

 private:
  std::unique_ptr<mjVFS> files_;
};

}  // namespace

std::string rover_model_text() {
  std::string text =
      "<mujoco model=\"rover\">\n<compiler angle=\"radian\" autolimits=\"true\"/>\n"
      "<option timestep=\"0.002\" cone=\"elliptic\" impratio=\"10\"/>\n"
      "<size nconmax=\"200\" njmax=\"800\"/>\n<visual><quality shadowsize=\"0\" offsamples=\"0\"/>\n<map "
      "znear=\"0.01\" zfar=\"10\"/>"
      "<headlight ambient=\"0.5 0.5 0.5\" diffuse=\"0.4 0.4 0.4\" specular=\"0 0 0\"/></visual>\n"
      "<statistic extent=\"1\"/>\n";
  text += kDefaults + assets() + "<worldbody>\n";
  text +=
      element("light", with("pos", {0, 0, 3}) + with("directional", "true") + with("castshadow", "false") +
                           with("diffuse", {0.4, 0.4, 0.4}) + with("specular", {0, 0, 0}));
  text += element("camera", with("name", "room") + with("pos", {-0.2, 2.7, 1.6}) +
                                with("mode", "targetbody") + with("target", "rover") + with("fovy", {38}));
  text += room() + rover_body();
  for (std::size_t number = 0; number < kBoxes; ++number)
    text += box(number);
  text += "</worldbody>\n<equality>" +
          element("joint", with("joint1", "right_finger") + with("joint2", "left_finger")) + "</equality>\n" +
          actuators() +
          "<sensor><accelerometer site=\"imu\"/><gyro site=\"imu\"/>"
          "<framequat objtype=\"site\" objname=\"imu\"/></sensor>\n</mujoco>\n";
  return text;
}

segue::Result<ModelPtr> load_rover_model() {
  // MuJoCo's parser keeps the last model that it read for all threads.
  static segue::Mutex mutex;
  const segue::Lock lock(mutex);
  Files files;
  apriltag_family_t* const family = tag36h11_create();
  for (std::size_t number = 0; number < kBoxes; ++number) {
    const auto texture = marker_texture(family, number);
    files.add("box_" + std::to_string(number) + ".texture", texture.data(), texture.size());
  }
  tag36h11_destroy(family);
  const std::string text = rover_model_text();
  files.add("rover.xml", text.data(), text.size());
  std::array<char, 500> problem{};
  ModelPtr model(mj_loadXML("rover.xml", files.get(), problem.data(), static_cast<int>(problem.size())));
  if (!model) {
    return segue::fail(segue::ErrorCode::Unsupported,
                       std::string("MuJoCo ") + mj_versionString() +
                           " does not take the model of the rover: " + problem.data());
  }
  return model;
}

}  // namespace rover
