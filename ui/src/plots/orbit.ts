// SPDX-License-Identifier: Apache-2.0

export interface Point3 {
  x: number;
  y: number;
  z: number;
}

/** A camera that looks at `target` from `distance` metres; z is upward. Angles in radians. */
export interface Orbit {
  target: Point3;
  /** The direction from the target to the camera in the plane: 0 along x, counter-clockwise. */
  yaw: number;
  /** How high the camera is above the plane: 0 level, a quarter turn from above. */
  pitch: number;
  distance: number;
}

export const fieldOfView = 45;
const lowest = -0.2;
const highest = Math.PI / 2 - 0.01;
const nearest = 0.2;
const farthest = 5000;

export const orbitAtFirst: Orbit = { target: { x: 0, y: 0, z: 0 }, yaw: -Math.PI * 0.7, pitch: 0.75, distance: 12 };

const between = (least: number, value: number, most: number) => Math.min(most, Math.max(least, value));

/** Where the camera is. */
export function cameraOf({ target, yaw, pitch, distance }: Orbit): Point3 {
  const flat = distance * Math.cos(pitch);
  return { x: target.x + flat * Math.cos(yaw), y: target.y + flat * Math.sin(yaw), z: target.z + distance * Math.sin(pitch) };
}

/** Turned around the target; never below the ground by much, nor over the top. */
export function turned(orbit: Orbit, yaw: number, pitch: number): Orbit {
  return { ...orbit, yaw: orbit.yaw + yaw, pitch: between(lowest, orbit.pitch + pitch, highest) };
}

/** `factor` times as near. */
export function nearer(orbit: Orbit, factor: number): Orbit {
  return { ...orbit, distance: between(nearest, orbit.distance / factor, farthest) };
}

/** Moved in the plane as seen: to the right and forward, by parts of the distance. */
export function moved(orbit: Orbit, right: number, forward: number): Orbit {
  const { target, yaw, distance } = orbit;
  const x = target.x + distance * (-Math.sin(yaw) * right - Math.cos(yaw) * forward);
  const y = target.y + distance * (Math.cos(yaw) * right - Math.sin(yaw) * forward);
  return { ...orbit, target: { ...target, x, y } };
}

/** Sees all points with some room around them, from the same side; as it was where there are none. `aspect`: width by height. */
export function fitted(orbit: Orbit, points: { x: number; y: number }[], aspect: number): Orbit {
  if (points.length === 0) return orbit;
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y } of points) {
    left = Math.min(left, x);
    right = Math.max(right, x);
    low = Math.min(low, y);
    high = Math.max(high, y);
  }
  const radius = Math.max(1, Math.hypot(right - left, high - low) / 2);
  const half = (fieldOfView * Math.PI) / 360;
  const narrow = Math.min(half, Math.atan(Math.tan(half) * aspect));
  return { ...orbit, target: { x: (left + right) / 2, y: (low + high) / 2, z: 0 }, distance: between(nearest, (radius * 1.1) / Math.sin(narrow), farthest) };
}
