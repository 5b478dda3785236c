// The camera that the mouse moves: { eye, target, up, zoom }.
const add = (a, b, t = 1) => a.map((x, i) => x + t * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => a.map((x) => x / length(a));
const turned = (a, axis, angle) => { // Rodrigues
  const c = Math.cos(angle), s = Math.sin(angle), along = dot(axis, a) * (1 - c), side = cross(axis, a);
  return a.map((x, i) => x * c + side[i] * s + axis[i] * along);
};
const STEEPEST = 1.55; // radians: straight down there is no way up

export const orbited = (pose, across, down) => {
  const up = unit(pose.up);
  let arm = turned(add(pose.eye, pose.target, -1), up, -across);
  const elevation = Math.asin(Math.max(-1, Math.min(1, dot(unit(arm), up))));
  const wanted = Math.max(-STEEPEST, Math.min(STEEPEST, elevation + down));
  arm = turned(arm, unit(cross(arm, up)), wanted - elevation);
  return { ...pose, eye: add(pose.target, arm) };
};

// across, down: in heights of the picture.
export const panned = (pose, across, down) => {
  const arm = add(pose.eye, pose.target, -1), right = unit(cross(pose.up, arm)), above = unit(cross(arm, right));
  const far = (0.83 * length(arm)) / pose.zoom; // what 45 degrees see
  const by = add(right.map((x) => -x * across * far), above, down * far);
  return { ...pose, eye: add(pose.eye, by), target: add(pose.target, by) };
};

export const nearer = (pose, factor, perspective) => perspective
  ? { ...pose, eye: add(pose.target, add(pose.eye, pose.target, -1).map((x) => x / factor)) }
  : { ...pose, zoom: Math.max(1e-3, Math.min(1e3, pose.zoom * factor)) };
