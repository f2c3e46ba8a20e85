// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Plans routes around round obstacles: straight ahead where that is free, else by way of the best of many
/// random points. Equal questions have equal answers.
class RoutePlanner final : public Component {
 public:
  RoutePlanner()
      : Component({.doc = "Plans routes between two points around round obstacles, by an operation"}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*iterations_ == 0) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "iterations must be at least 1");
    }
    return {};
  }

 private:
  /// It takes `effort`, as a planner does that has a hard task.
  Route plan(Point from, Point to) const {
    const auto end = std::chrono::steady_clock::now() + *effort_;
    Route route{"no_route", {}, 0};
    if (is_free(from, to)) {
      route = {"found", {from, to}, distance(from, to)};
    } else {
      std::mt19937_64 random(*seed_);
      std::uniform_real_distribution<double> place(-*room_, *room_);
      for (std::uint32_t i = 0; i < *iterations_; ++i) {
        const double x = place(random);
        try_by_way_of({x, place(random)}, from, to, route);
      }
    }
    std::this_thread::sleep_until(end);
    return route;
  }

  void try_by_way_of(Point via, Point from, Point to, Route& best) const {
    const double length = distance(from, via) + distance(via, to);
    if (!best.points.empty() && length >= best.length) return;
    if (is_free(from, via) && is_free(via, to)) best = {"found", {from, via, to}, length};
  }

  static double distance(Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

  bool is_free(Point from, Point to) const {
    return std::all_of(obstacles_->begin(), obstacles_->end(), [&](const Obstacle& obstacle) {
      const double length = distance(from, to);
      const double along =
          length == 0 ? 0
                      : ((obstacle.x - from.x) * (to.x - from.x) + (obstacle.y - from.y) * (to.y - from.y)) /
                            (length * length);
      const double t = std::clamp(along, 0.0, 1.0);
      const Point nearest{from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)};
      return distance(nearest, {obstacle.x, obstacle.y}) > obstacle.radius;
    });
  }

  Property<std::uint64_t> seed_{*this, "seed", 1, {.live = true, .doc = "of the random points"}};
  Property<std::uint32_t> iterations_{*this, "iterations", 1000, {.doc = "random points that are tried"}};
  Property<std::chrono::milliseconds> effort_{
      *this, "effort", std::chrono::milliseconds(0), {.live = true, .doc = "least time that a plan takes"}};
  Property<double> room_{*this, "room", 5.0, {.doc = "m; the room reaches from -room to room in x and y"}};
  Property<std::vector<Obstacle>> obstacles_{
      *this, "obstacles", {{2.0, 0.5, 0.5}, {-1.5, 2.0, 0.8}}, {.doc = "obstacles in the room"}};
  Operation<Route(Point, Point)> plan_{*this,
                                       "plan",
                                       {"from", "to"},
                                       [this](Point from, Point to) { return plan(from, to); },
                                       RunsIn::TaskThread,
                                       "a route from one point to another"};
};

}  // namespace demo

SEGUE_COMPONENT(demo::RoutePlanner)
