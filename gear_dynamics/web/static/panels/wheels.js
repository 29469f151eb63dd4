// The two wheels turning in slow motion, the faulty tooth marked, the forces as arrows.

import {lineColour, themeColour} from '../colours.js';
import {Panel, choice, make} from '../panel.js';
import {short} from '../units.js';
import {change, onChange, view} from '../view.js';

const SLOW = [1, 10, 50, 200, 1000];

export class Wheels {
  constructor() {
    const slow = choice('slow motion', SLOW.map(String), String(view.slow),
      (text) => change({slow: Number(text)}));
    for (const option of slow.options) option.textContent = `1 : ${option.value}`;
    this.canvas = make('canvas');
    this.panel = new Panel('wheels', 'Wheels', {canvas: () => this.canvas, tools: [slow]});
    this.panel.body.append(this.canvas);
    this.note = make('div', {className: 'legend'});
    this.panel.element.append(this.note);
    this.angle = 0;
    this.cycle = {normal: [], friction: []};
    this.last = performance.now();
    onChange(() => (slow.value = String(view.slow)));
    requestAnimationFrame((now) => this.turn(now));
  }

  describe(state) {
    this.state = state;
  }

  take({arrays}) {
    this.cycle = {normal: arrays.cycle_mesh_force, friction: arrays.cycle_friction_force};
  }

  turn(now) {
    const step = Math.min(now - this.last, 100) / 1000;
    this.last = now;
    const {state} = this;
    const paused = state?.health?.simulator?.message === 'paused' || !(state?.age < 1);
    if (state && !paused) this.angle += (step * (state.latest.speed ?? 0)) / view.slow;
    const geometry = this.geometry();
    if (geometry) {
      this.panel.filled();
      this.draw(geometry);
    } else this.panel.filled('no gear pair is described');
    requestAnimationFrame((later) => this.turn(later));
  }

  geometry() {
    const {pinion_teeth: z1, gear_teeth: z2, module, pressure_angle_deg: degrees} =
      this.state?.configuration?.parameters ?? {};
    if (!(z1 > 0 && z2 > 0 && module > 0)) return null;
    return {z1, z2, module, alpha: (degrees * Math.PI) / 180};
  }

  draw({z1, z2, module, alpha}) {
    const {canvas} = this;
    const ratio = devicePixelRatio;
    const width = this.panel.body.clientWidth;
    const height = this.panel.body.clientHeight;
    if (canvas.width !== width * ratio || canvas.height !== height * ratio) {
      canvas.width = width * ratio;
      canvas.height = height * ratio;
      canvas.style.width = `${width}px`;
      canvas.style.height = `${height}px`;
    }
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const scale = Math.min(width / ((z1 + z2 + 6) * module), height / ((Math.max(z1, z2) + 4) * module));
    const [r1, r2] = [(z1 * module * scale) / 2, (z2 * module * scale) / 2];
    const left = (width - 2 * (r1 + r2)) / 2;
    const [c1, c2, y] = [left + r1, left + 2 * r1 + r2, height / 2];
    const faulty = (wheel) => (this.state?.faults ?? []).find((each) => each.wheel === wheel && each.tooth !== '');
    this.wheel(context, c1, y, r1, z1, module * scale, this.angle, faulty('pinion'), lineColour(0));
    // A tooth of one meets a gap of the other on the line of centres; the pair counter-rotates.
    const turned = Math.PI + Math.PI / z2 - (this.angle * z1) / z2;
    this.wheel(context, c2, y, r2, z2, module * scale, turned, faulty('gear'), lineColour(4));
    this.arrows(context, c1 + r1, y, alpha, z1, Math.min(width, height) / 3.2);
  }

  wheel(context, x, y, radius, teeth, module, angle, fault, colour) {
    const [tip, root] = [radius + module, radius - 1.25 * module];
    const pitch = (2 * Math.PI) / teeth;
    context.lineWidth = 1.2;
    context.strokeStyle = colour;
    context.beginPath();
    for (let k = 0; k < teeth; k++) {
      const middle = angle + k * pitch;
      for (const [r, share] of [[root, -0.36], [tip, -0.14], [tip, 0.14], [root, 0.36]]) {
        context.lineTo(x + r * Math.cos(middle + share * pitch), y + r * Math.sin(middle + share * pitch));
      }
    }
    context.closePath();
    context.stroke();
    context.beginPath();
    context.arc(x, y, 0.22 * radius, 0, 2 * Math.PI);
    context.moveTo(x + 0.22 * radius * Math.cos(angle), y + 0.22 * radius * Math.sin(angle));
    context.lineTo(x + 0.5 * radius * Math.cos(angle), y + 0.5 * radius * Math.sin(angle));
    context.stroke();
    if (fault) {
      const middle = angle + Number(fault.tooth) * pitch;
      context.fillStyle = themeColour('error');
      context.beginPath();
      context.arc(x + radius * Math.cos(middle), y + radius * Math.sin(middle), 0.9 * module + 2, 0, 2 * Math.PI);
      context.fill();
    }
  }

  /** Draw the forces on the pinion at the pitch point, at the phase that is shown. */
  arrows(context, x, y, alpha, teeth, longest) {
    const {normal, friction} = this.cycle;
    if (!normal?.length) {
      this.note.textContent = '';
      return;
    }
    const phase = ((this.angle * teeth) / (2 * Math.PI)) % 1;
    const index = Math.floor(phase * normal.length);
    const [f, t] = [normal[index], friction[index]];
    const largest = Math.max(...normal.map(Math.abs), 1e-9);
    // The line of action is inclined to the common tangent by the pressure angle.
    const along = [Math.sin(alpha), -Math.cos(alpha)];
    const across = [Math.cos(alpha), Math.sin(alpha)];
    this.arrow(context, x, y, along, (-f / largest) * longest, lineColour(1));
    this.arrow(context, x, y, across, (-t / largest) * longest * 10, lineColour(2));
    this.note.replaceChildren(
      this.key(lineColour(1), `mesh force ${short(f)} N`),
      this.key(lineColour(2), `friction ${short(t)} N (drawn × 10)`),
      this.key(themeColour('error'), 'faulty tooth'));
  }

  key(colour, text) {
    const item = make('span', {}, make('i'), text);
    item.firstChild.style.background = colour;
    return item;
  }

  arrow(context, x, y, [dx, dy], length, colour) {
    if (Math.abs(length) < 1) return;
    const [tx, ty] = [x + dx * length, y + dy * length];
    const angle = Math.atan2(ty - y, tx - x);
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 2.5;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(tx, ty);
    context.stroke();
    context.beginPath();
    for (const turn of [0, 2.6, -2.6]) {
      context.lineTo(tx + 7 * Math.cos(angle + turn), ty + 7 * Math.sin(angle + turn));
    }
    context.fill();
  }
}
