// SPDX-License-Identifier: Apache-2.0
#include "occupancy_map.hpp"
#include "pose_history.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cmath>
#include <optional>

namespace navigation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Makes a map from the scans of a laser scanner and the poses at which they were taken.
class GridMapper final : public Component {
 public:
  GridMapper()
      : Component(
            {.doc = "Makes a map of what is occupied from laser scans and poses", .trigger_on = {"scan"}}) {}

 private:
  static constexpr double kMostCells = 64e6;

  segue::Result<void> on_configure() override {
    const double columns = std::ceil(*width_ / *resolution_);
    const double rows = std::ceil(*height_ / *resolution_);
    if (!(*resolution_ > 0) || !(columns >= 1) || !(rows >= 1) || !(columns * rows <= kMostCells)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "resolution, width and height must be positive and give at most 64 million cells");
    }
    const GridFrame frame{*resolution_, *x_, *y_, static_cast<int>(columns), static_cast<int>(rows)};
    map_.emplace(frame, SensorModel{*hit_, *miss_, *maximum_, *longest_beam_});
    messages::OccupancyGrid example;
    map_->write_to(example);
    map_out_.prime(example);
    return {};
  }

  segue::Result<void> on_start() override {
    poses_.clear();
    published_.reset();
    return {};
  }

  void on_update() override {
    messages::Odometry pose;
    while (pose_in_.read(pose) == ReadStatus::NewData)
      poses_.add(pose);
    double time = 0;
    bool entered = false;
    while (const auto scan = scan_in_.take()) {
      const auto vehicle = poses_.at(scan->time);
      if (!vehicle) continue;
      map_->integrate(*scan, compose(*vehicle, *sensor_));
      time = scan->time;
      entered = true;
    }
    if (entered && (!published_ || now() - *published_ >= *publish_period_)) publish(time);
  }

  void on_cleanup() override { map_.reset(); }

  void publish(double time) {
    auto grid = map_out_.loan();
    if (!grid) return;
    grid->time = time;
    map_->write_to(*grid);
    grid.publish();
    published_ = now();
  }

  InputPort<messages::Odometry> pose_in_{*this, "pose", {.doc = "of the vehicle in the frame of the map"}};
  InputPort<messages::LaserScan> scan_in_{*this, "scan"};
  OutputPort<messages::OccupancyGrid> map_out_{*this, "map"};
  Property<double> resolution_{*this, "resolution", 0.05, {.doc = "m; side of a cell"}};
  Property<double> x_{*this, "x", -10.0, {.doc = "m; the map's smallest x"}};
  Property<double> y_{*this, "y", -10.0, {.doc = "m; the map's smallest y"}};
  Property<double> width_{*this, "width", 20.0, {.doc = "m; the map's extent in x"}};
  Property<double> height_{*this, "height", 20.0, {.doc = "m; the map's extent in y"}};
  Property<Pose2D> sensor_{*this, "sensor", {}, {.live = true, .doc = "pose of the scanner on the vehicle"}};
  Property<double> hit_{
      *this, "hit", 0.85, {.doc = "log odds that a beam adds to the cell in which it ends"}};
  Property<double> miss_{*this, "miss", -0.4, {.doc = "log odds that a beam adds to the cells it crosses"}};
  Property<double> maximum_{*this, "maximum", 4.0, {.doc = "log odds; no cell is surer than this"}};
  Property<double> longest_beam_{
      *this, "longest_beam", 10.0, {.doc = "m; what lies farther away is not entered"}};
  Property<std::chrono::milliseconds> publish_period_{*this,
                                                      "publish_period",
                                                      std::chrono::milliseconds(500),
                                                      {.live = true, .doc = "least time between maps"}};
  Operation<void()> clear_{*this,
                           "clear",
                           {},
                           [this] {
                             if (map_) map_->clear();
                           },
                           RunsIn::TaskThread,
                           "forgets the map"};

  std::optional<OccupancyMap> map_;
  PoseHistory poses_;
  std::optional<segue::TimePoint> published_;
};

}  // namespace navigation

SEGUE_COMPONENT(navigation::GridMapper)
