// Units and names of columns as people read them.

const UNITS = {
  pinion_ax: 'm/s²', pinion_ay: 'm/s²', gear_ax: 'm/s²', gear_ay: 'm/s²',
  mesh_force: 'N', friction_force: 'N', delta: 'm', delta_dot: 'm/s',
  pinion_angle: 'rad', gear_angle: 'rad', speed: 'rad/s', load_torque: 'N m',
};

/** Unit of a channel: of the rig's description, or of the simulated rig's column. */
export function unitOf(channel, configuration) {
  const described = configuration?.machine?.channels?.[channel]?.unit;
  return (described ?? UNITS[channel] ?? '').replace('m/s2', 'm/s²');
}

export function label(name) {
  return name.replaceAll('_', ' ');
}

/** A number in at most four significant digits. */
export function short(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(2).replace(/\.?0+e/, 'e');
  return String(Number(value.toPrecision(4)));
}
