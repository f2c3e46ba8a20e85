// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <array>

/// How the rover's six steered wheels move it and how it moves by them. Plain computations: any thread,
/// real-time safe. Wheels are in the order of kWheelPlaces.
namespace rover {

using PerWheel = std::array<double, 6>;

/// Steering angles with which no wheel slips sideways at this velocity; unchanged where the wheel need not
/// move. Two angles are possible, since wheels roll both ways; it gives the one that is nearer to where the
/// wheel points now.
PerWheel steering_for(const messages::Twist2D& twist, const PerWheel& steering);

/// Speeds in rad/s of wheels that point where `steering` says: the wanted velocity of each, as far as it lies
/// in its direction. So wheels that are not yet steered as wanted do not drag the rover elsewhere.
PerWheel speeds_for(const messages::Twist2D& twist, const PerWheel& steering);

/// The movement of the rover's frame while its wheels turned by `angles` (rad), in that frame as it was
/// before: the movement with the least squared slip of all wheels. Holds for small angles.
messages::Pose2D movement_of(const PerWheel& angles, const PerWheel& steering);

/// The pose after a movement in the frame of `pose`.
messages::Pose2D moved(const messages::Pose2D& pose, const messages::Pose2D& movement);

}  // namespace rover
