// The line at the top: how the machine runs and how fresh the data are.

import {make} from '../panel.js';
import {short} from '../units.js';
import {change} from '../view.js';
import {fill} from '../panel.js';

const OLD = 1.0; // s without a block after which it is said

export class StateLine {
  constructor() {
    this.until = 0;
    this.output = document.getElementById('state');
    this.alert = document.getElementById('alert');
    this.rig = document.getElementById('rig');
    this.rig.addEventListener('change', () => change({rig: this.rig.value}));
  }

  describe(state) {
    const {latest, age, health, conditions, rigs} = state;
    this.rig.parentElement.hidden = rigs.length < 2;
    fill(this.rig, rigs, state.rig);
    const parts = {
      speed: `${short((latest.speed * 60) / (2 * Math.PI))} rpm`,
      load: `${short(latest.load_torque)} N m`,
    };
    if (latest.speed === undefined) delete parts.speed;
    if (latest.load_torque === undefined) delete parts.load;
    const motion = conditions.motion;
    if (motion) {
      parts.motion = motion.message;
      const exponent = Number(motion.values.lyapunov);
      if (Number.isFinite(exponent) && exponent !== 0) parts.exponent = short(exponent);
    }
    const operation = conditions.operation ?? conditions.operating_state;
    if (operation) parts.operation = operation.message;
    for (const [name, {values, message}] of Object.entries(health)) {
      if (values.real_time_factor !== undefined) parts['real time'] = `× ${short(Number(values.real_time_factor))}`;
      if (values.gaps !== undefined) parts.gaps = values.gaps;
      if (/log$/.test(name)) parts.log = message;
    }
    parts.age = age > 99 ? '–' : `${short(Math.max(age, 0))} s`;
    this.output.replaceChildren(...Object.entries(parts).map(
      ([name, value]) => make('span', {}, `${name} `, make('b', {}, String(value)))));
    this.say(age > OLD && health.simulator?.message !== 'paused'
      ? `no data for ${short(age)} s` : '');
  }

  /** Show a line; one about a command stays for a while. */
  say(text, seconds = 0) {
    const now = performance.now() / 1000;
    if (!seconds && now < this.until) return;
    this.until = now + seconds;
    this.alert.hidden = !text;
    this.alert.textContent = text;
  }
}
